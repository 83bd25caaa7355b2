"""Attacks on what the feedforward is told of: a payload that somebody declared for somebody else, or took back by another way."""
import numpy as np
import rospy
from dynamic_reconfigure.msg import Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure

from knee_robot.srv import SetProperty

from attacks_by_others import load_patient

PAYLOAD_KG = 25.0


def reconfigure(name, value):
    rospy.ServiceProxy("/controller/feedforward/set_parameters", Reconfigure)(Config(doubles=[DoubleParameter(name, value)]))


def declare(a, payload_kg):
    answer = a.session.call("set_property", SetProperty, "Feedforward", "payload_kg", f"{payload_kg:g}")
    if not answer.success:
        raise RuntimeError(answer.message)


def enabled_with_nothing_on_it(a, said):
    """How far the platform jumps when the brakes open."""
    a.begin()
    a.enable()
    heights = a.rows()["pose"][:, 1]
    jump = 1e3 * float(np.max(np.abs(heights - heights[0])))
    state = a.state()
    text, good = a.disable_and_look()
    return f"{said}; enabled, the platform jumps by {jump:.1f} mm ({state}); ", text, good and jump < 1.0


def payload_of_the_patient_before(a):
    """25 kg are declared for a patient, who leaves; somebody declares the robot empty and enables it."""
    declare(a, PAYLOAD_KG)
    load_patient(a)
    for service in ("clear_patient", "declare_empty"):
        a.session.trigger(service)
    return enabled_with_nothing_on_it(a, "the patient of 25 kg has left")


def payload_that_was_taken_back(a):
    """25 kg are declared by dynamic_reconfigure and taken back by set_property; then somebody changes another share by dynamic_reconfigure."""
    reconfigure("payload_kg", PAYLOAD_KG)
    declare(a, 0.0)
    reconfigure("share_friction", 0.8)
    return enabled_with_nothing_on_it(a, "25 kg were taken back")


def attacks():
    return {f.__name__: f for f in (payload_of_the_patient_before, payload_that_was_taken_back)}
