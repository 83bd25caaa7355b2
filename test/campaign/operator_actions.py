"""What an operator, a careless one or his disk does to a running controller; each is called with the run."""
import os
import pathlib
import shutil
import threading
import time

import rospy
from std_srvs.srv import Trigger

from session import NoAnswer


def refuse(run, answer, *words):
    """`answer` has to be a refusal that says these words."""
    run.note = answer.message
    if answer.success:
        run.wrong = "was not refused: " + answer.message
    for word in words:
        if word not in answer.message:
            run.wrong = f"refused without saying '{word}': {answer.message}"


def start_twice(run):
    run.at_injection()
    refuse(run, run.session.trigger("start"), "playing")


def load_while_playing(run):
    run.at_injection()
    refuse(run, run.session.load(run.reference.name))


def replace_file(run):
    """Another content under the same name while it is played, written over in place."""
    run.at_injection()
    run.reference.write_text("9 9 9 9\nnan inf 0 -1\n" * 200)


def remove_recordings_folder(run):
    """The recording's file is unlinked and its folder renamed under the controller."""
    run.at_injection()
    folder = run.session.recordings
    gone = folder.with_name(folder.name + "_gone")
    shutil.rmtree(gone, ignore_errors=True)  # of a run that was broken off
    os.rename(folder, gone)
    time.sleep(0.7)
    folder.mkdir(exist_ok=True)  # the controller may have made it anew
    for one in gone.iterdir():
        if not (folder / one.name).exists():
            os.rename(one, folder / one.name)
    shutil.rmtree(gone)


def flood(run):
    """Every service that may be called at any time, from eight callers at once, for a second and a half."""
    run.at_injection()
    end = time.monotonic() + 1.5
    calls = [0]

    def caller(number):
        names = ("get_state", "start", "enable", "approach", "reset_faults", "load_reference")
        while time.monotonic() < end:
            name = names[(number + calls[0]) % len(names)]
            try:
                if name == "get_state":
                    run.session.state()
                elif name == "load_reference":
                    run.session.load("no_such_file.txt")
                else:
                    rospy.ServiceProxy(f"/controller/{name}", Trigger)()
            except (NoAnswer, rospy.ServiceException):
                pass
            calls[0] += 1

    threads = [threading.Thread(target=caller, args=(i,)) for i in range(8)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    run.note = f"{calls[0]} calls"


def bad_requests(run):
    run.at_injection()
    names = ("../../etc/passwd", "/dev/zero", "x" * 100000, "a\0b", "\n", "", ".", "\u00e4\u20ac", "%s%s%n")
    for name in names:
        for call in (lambda n=name: run.session.load(n), lambda n=name: run.session.load(run.reference.name, n),
                     lambda n=name: run.session.record(True, n)):
            try:
                if call().success:
                    run.wrong = f"accepted {name[:20]!r}"
            except NoAnswer as error:
                run.wrong = str(error)


def abuse_parameters(run):
    """The parameter server's values are set to rubbish and deleted while the robot moves."""
    run.at_injection()
    for name, value in (("robot", "/dev/null"), ("hardware", 5), ("deployment", ["x"] * 1000), ("guardian", ""), ("shm", "/x"),
                        ("rate_hz", -1.0), ("recordings", "/"), ("references", {"a": 1})):
        rospy.set_param(f"/controller/{name}", value)
    for name in ("robot", "rate_hz"):
        rospy.delete_param(f"/controller/{name}")


def press_service(run):
    run.at_injection()
    answer = run.session.trigger("emergency_stop")
    if not answer.success:
        run.wrong = answer.message


def disable(run):
    run.at_injection()
    run.session.trigger("disable")


def disable_with_open_brake(axis):
    def do(run):
        run.session.inject("hold_open", axis)
        disable(run)
    return do


def fill_disk(run):
    """Takes what the small file system of this run still has."""
    run.at_injection()
    with open(pathlib.Path(run.recording.parent) / "filler", "wb", buffering=0) as filler:
        try:
            while True:
                filler.write(b"\0" * 65536)
        except OSError:
            pass


def says_disk_is_full(run):
    words = run.recording_answer or ""
    if "No space left" not in words:
        return f"the controller did not say that the disk is full: {words!r}"
    return None
