"""Stops in the controller's event log: whatever was planned before one of them must not move after it."""
STOPPING = ("stop", "disable", "emergency_stop")


def is_stop(event):
    """`event` as a dict: somebody has stopped the robot, or a fault has."""
    return event["kind"] == "fault" or (event["kind"] == "request" and event["what"] in STOPPING)


def objection(events, since):
    """Why nothing may begin that was planned when the newest entry had the number `since` (0: there was none). `events`: those from this one
    on. Empty: nobody has stopped the robot since then."""
    if since > 0 and not any(event["number"] == since for event in events):
        return "the controller was started anew meanwhile, or does not remember all that has happened since"
    for event in events:
        if event["number"] > since and is_stop(event):
            if event["kind"] == "fault":
                return f"the robot had the fault {event['what']} meanwhile"
            return f"{event['who'] or 'somebody'} has stopped the robot meanwhile ({event['what']})"
    return ""
