"""For catkin only (catkin_python_setup): the modules of the operator's page. Nobody calls this file."""
from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["knee_robot_operator"], package_dir={"": "python"}))
