"""Help is asked for where nothing is installed yet, and installs nothing."""
import pathlib
import subprocess

import pytest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"


@pytest.mark.parametrize("script", ["fleet", "fleet_campaign", "fleet_scale"])
def test_help_installs_nothing(script, tmp_path):
    build = tmp_path / "build"
    answer = subprocess.run([SCRIPTS / script, "--help"], env={"PATH": "/usr/bin:/bin", "KNEE_BUILD": str(build)}, capture_output=True,
                            text=True, check=False)
    assert answer.returncode == 0 and answer.stderr == ""
    assert f"Usage: scripts/{script}" in answer.stdout
    assert not build.exists()
