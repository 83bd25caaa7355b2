"""The clock of a machine is its own."""
import rospy

SENTENCE = ("the parameter /use_sim_time is true: time would be what somebody publishes on /clock; "
            "rosparam set /use_sim_time false, and start again")


def objection():
    """Why nothing may begin; empty where time is the machine's."""
    return SENTENCE if rospy.get_param("/use_sim_time", False) else ""
