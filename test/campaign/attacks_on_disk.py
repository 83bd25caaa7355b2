"""Attacks by the disk: it hangs (hung_disk.c), or it is full."""
import subprocess
import time


from knee_robot.msg import PlayGoal

from attack import how_it_ended, needs, play_client, preloaded

QUICK_MS = 500.0  # a service that has nothing to do with the disk
ENDS_S = 20.0


def preload(session):
    """Environment of a controller whose disk can hang."""
    session.hung = session.folder / "hung"
    return {"LD_PRELOAD": preloaded("hung_disk", session.folder), "KNEE_HUNG_DISK": str(session.hung),
            "KNEE_HUNG_FOLDER": str(session.recordings)}


def let_go(session):
    """After the attack: the disk answers again, and is whole."""
    if hasattr(session, "hung") and session.hung.exists():
        session.hung.unlink()
    if getattr(session, "small_disk", False):
        subprocess.run(["umount", "-l", str(session.recordings)], check=False)


def answers_quickly(a):
    slowest = a.slowest_ms(a.session.state)
    text = "get_state does not answer" if slowest is None else f"get_state answers within {slowest:.0f} ms"
    return text, slowest is not None and slowest < QUICK_MS


@needs(preload=preload)
def disk_hangs_while_recording_and_playing(a):
    """The disk hangs under a recording; 0.7 s later get_state, then the hand switch, then the end of the recording."""
    a.session.record(True, "r.csv")
    a.enable()
    a.play()
    a.session.hung.touch()
    time.sleep(0.7)
    told, quick = answers_quickly(a)
    a.begin()
    a.session.inject("hand_switch")
    text, good = a.look(1.5)
    ending = a.call_aside(lambda: a.session.record(False))
    time.sleep(4.5)
    ended = bool(ending) and not isinstance(ending[0], Exception)
    said = ending[0].message.replace(str(a.session.recordings), "")[:80] if ended else "no answer"
    return f"{told}; end of the recording: {said}; ", text, quick and good and ended


@needs(preload=preload)
def disk_hangs_then_stop_and_shutdown(a):
    """The disk hangs under a recording while playing; stop, then SIGTERM."""
    a.session.record(True, "r.csv")
    a.enable()
    a.play()
    a.session.hung.touch()
    time.sleep(0.5)
    stops = a.slowest_ms(lambda: a.session.trigger("stop"), 1)
    a.begin()
    ended = a.end_controller(ENDS_S)
    text, good = a.look(0.5)
    last = f"stop answers within {stops:.0f} ms; " if stops is not None else "stop does not answer; "
    last += how_it_ended(ended)
    return last, text, good and stops is not None and stops < QUICK_MS and ended is not None


@needs(preload=preload)
def disk_hangs_when_a_recording_begins(a):
    """set_recording on a disk that hangs; meanwhile enable, get_state and disable."""
    a.session.hung.touch()
    answer = a.call_aside(lambda: a.session.record(True, "r.csv"))
    time.sleep(0.3)
    told, quick = answers_quickly(a)
    enabled = a.slowest_ms(lambda: a.session.trigger("enable"), 1)
    a.begin()
    disabled = a.slowest_ms(lambda: a.session.trigger("disable"), 1)
    text, good = a.look(1.0)
    a.session.hung.unlink()
    time.sleep(1.0)
    both = enabled is not None and disabled is not None
    return (f"{told}; enable and disable {'answer' if both else 'do not answer'}; set_recording "
            f"{'answers when the disk does' if answer else 'hangs for ever'}; ", text, quick and good and both and bool(answer))


@needs(preload=preload)
def disk_hangs_when_a_recording_begins_then_shutdown(a):
    """Holding; set_recording waits for a disk that hangs, then SIGTERM: the drives must not stay on for a call that does not come back."""
    a.enable()
    a.session.hung.touch()
    a.call_aside(lambda: a.session.record(True, "r.csv"))
    time.sleep(0.5)
    a.begin()
    ended = a.end_controller(ENDS_S)
    text, good = a.look(0.5)
    last = how_it_ended(ended)
    return last, text, good and ended is not None


@needs(preload=preload)
def disk_hangs_while_the_black_box_writes(a):
    """A fault while the disk hangs: its black box cannot be written; reset, enable and another fault."""
    a.enable()
    a.session.hung.touch()
    a.session.inject("hand_switch")
    time.sleep(1.5)
    a.session.inject("clear")
    time.sleep(0.1)
    told, quick = answers_quickly(a)
    reset = a.session.trigger("reset_faults")
    again = a.session.trigger("enable")
    time.sleep(1.0)
    a.begin()
    a.session.inject("hand_switch")
    text, good = a.look(1.5)
    return (f"{told}; reset {'done' if reset.success else reset.message[:60]}, enable {'done' if again.success else again.message[:60]}; ",
            text, quick and good and reset.success and again.success)


@needs(preload=preload)
def disk_hangs_while_somebody_says_who_is_there(a):
    """declare_empty on a disk that hangs: nothing moves meanwhile, and everything else answers."""
    a.session.hung.touch()
    answer = a.call_aside(lambda: a.session.trigger("clear_patient"))
    time.sleep(0.3)
    told, quick = answers_quickly(a)
    a.begin()
    enable = a.session.trigger("enable")
    stop = a.slowest_ms(lambda: a.session.trigger("emergency_stop"), 1)
    text, good = a.look(1.0)
    a.session.hung.unlink()
    time.sleep(1.0)
    return (f"{told}; enable {'succeeded' if enable.success else 'refused'}; emergency_stop {'answers' if stop is not None else 'hangs'}; ", text,
            quick and good and not enable.success and stop is not None and bool(answer))


@needs(preload=preload)
def disk_hangs_and_a_goal_is_cancelled(a):
    """A play goal that records; the disk hangs; the goal is cancelled."""
    a.enable()
    path = a.write_path()
    with play_client() as client:
        client.send_goal(PlayGoal(file=path.name, record=True, recording="goal.csv"))
        time.sleep(1.5)
        a.session.hung.touch()
        time.sleep(0.5)
        before = a.session.state().state
        client.cancel_goal()
        began = time.monotonic()
        while a.session.state().state != "holding" and time.monotonic() - began < 5.0:
            time.sleep(0.02)
        stopped = time.monotonic() - began
    text, good = a.disable_and_look()
    return f"{before}; at rest {stopped:.1f} s after the cancel; ", text, good and before == "playing" and stopped < 2.0


@needs(preload=preload)
def disk_hangs_before_a_goal_moves_then_stop(a):
    """A play goal that records waits for a disk that hangs; somebody presses stop and is told that it is done; then the disk answers again."""
    a.enable()
    path = a.write_path()
    a.session.hung.touch()
    with play_client() as client:
        client.send_goal(PlayGoal(file=path.name, record=True, recording="goal.csv"))
        time.sleep(1.0)
        a.begin()
        answer = a.session.trigger("stop")
        time.sleep(0.2)
        a.session.hung.unlink()
        time.sleep(2.0)
        moved, state = a.moved_mm(), a.state()
        client.cancel_goal()
    a.session.wait_for(("holding",), 10.0)
    text, good = a.disable_and_look()
    said = f"stop {'succeeded' if answer.success else 'failed'}"
    return f"{said}; then it moved {moved:.1f} mm ({state}); ", text, good and answer.success and moved < 0.2


@needs(preload=preload)
def disk_hangs_and_the_master_is_restarted(a):
    """Holding; set_recording waits for a disk that hangs; then another master answers, which nobody can be found by until the call is back."""
    a.enable()
    a.session.hung.touch()
    a.call_aside(lambda: a.session.record(True, "r.csv"))
    time.sleep(0.5)
    a.begin()
    a.master.stop()
    time.sleep(0.5)
    a.master.start()
    text, good = a.look(6.0)
    ended = a.end_controller(ENDS_S)
    last = how_it_ended(ended)
    return last, text, good and ended is not None


def fill(a):
    folder = a.session.recordings
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"no small file system can be mounted here: {done.stderr.strip()}")
    a.session.small_disk = True
    with open(folder / "filler", "wb", buffering=0) as filler:
        try:
            while True:
                filler.write(b"\0" * 4096)
        except OSError:
            pass


def disk_full_from_the_beginning(a):
    """No byte left: a recording, a patient who is cleared, a fault with its black box, reset, shutdown."""
    fill(a)
    refused = a.session.record(True, "r.csv")
    a.enable()
    a.begin()
    a.session.inject("hand_switch")
    text, good = a.look(1.5)
    a.session.inject("clear")
    time.sleep(0.1)
    reset = a.session.trigger("reset_faults")
    error = a.session.state()
    ended = a.end_controller(ENDS_S)
    return (f"recording {'accepted' if refused.success else 'refused: ' + refused.message[-30:]}; {error.state}; "
            f"ended after {ended if ended is None else round(ended, 1)} s; ", text,
            good and reset.success and not refused.success and ended is not None)


def disk_full_when_the_controller_starts(a):
    """Both die; the disk is full when they come back."""
    fill(a)
    a.enable()
    a.begin()
    a.kill("guardian", "controller")
    a.session.start_guardian()
    a.session.start_controller()
    text, good = a.look(4.0)
    state = a.state()
    return f"{state}; ", text, good and ("disabled" in state or "not_reset" in state)


def attacks():
    return {f.__name__: f for f in (disk_hangs_while_recording_and_playing, disk_hangs_then_stop_and_shutdown,
                                    disk_hangs_when_a_recording_begins, disk_hangs_when_a_recording_begins_then_shutdown,
                                    disk_hangs_while_the_black_box_writes, disk_hangs_while_somebody_says_who_is_there,
                                    disk_hangs_and_a_goal_is_cancelled, disk_hangs_before_a_goal_moves_then_stop,
                                    disk_hangs_and_the_master_is_restarted,
                                    disk_full_from_the_beginning, disk_full_when_the_controller_starts)}



