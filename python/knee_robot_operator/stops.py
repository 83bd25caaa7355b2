"""Stops in the controller's event log: whatever was planned before one of them must not move after it."""
STOPPING = ("stop", "disable", "emergency_stop")
_OCCUPANCY = ("load_patient", "clear_patient", "declare_empty")
_MOVING = ("play", "approach", "start", "guide", "home")


def is_stop(event):
    """`event` as a dict: somebody has stopped the robot, or a fault has."""
    return event["kind"] == "fault" or any(is_asked(event, what) for what in STOPPING)


def is_asked(event, what):
    """Somebody has asked for it, with whatever arguments, and it was granted."""
    return event["kind"] == "request" and event["what"].replace(",", " ").split(" ", 1)[0] == what


def entry(number, time_s):
    """An entry as a word: a controller that is started anew begins its numbers from one."""
    return f"{number}@{time_s:.3f}"


def number_of(since):
    """Of an entry as entry() names it, or of its number alone. ValueError."""
    number, _, time_s = str(since).partition("@")
    float(time_s or 0.0)
    return int(number)


def objection(events, since, own=""):
    """Why nothing may begin that was planned when the newest entry was `since` (as entry() names it, or its number; 0: there was none). `events`:
    those from this one on. Empty: nobody has stopped the robot since then, changed who is on it, or, but for the node `own`, moved it."""
    number = number_of(since)

    def is_that(event):
        return event["number"] == number and str(since) in (str(number), entry(number, event["time"]))

    if number > 0 and not any(map(is_that, events)):
        return "the controller was started anew meanwhile, or does not remember all that has happened since"
    return _stopped([event for event in events if event["number"] > number], own)


def _stopped(events, own):
    paused_by = None  # at the very end of a movement a pause is granted, and the robot holds before it is at rest on the path
    for event in events:
        who = event["who"] or "somebody"
        if event["kind"] == "fault":
            return f"the robot had the fault {event['what']} meanwhile"
        if is_stop(event):
            return f"{who} has stopped the robot meanwhile ({event['what']})"
        if any(is_asked(event, what) for what in _OCCUPANCY):
            return f"{who} has changed who is on the robot meanwhile ({event['what']})"
        if event["who"] != own and any(is_asked(event, what) for what in _MOVING):
            return f"{who} has moved the robot meanwhile ({event['what']})"
        if is_asked(event, "pause"):
            paused_by = who
        elif is_asked(event, "resume"):
            paused_by = None
    return f"{paused_by} has paused the robot meanwhile, and nobody has resumed it" if paused_by else ""
