"""The faults of the campaign: how each is brought about, and what has to be said of it. Names of causes are those of
src/control/faults.cpp; several where more than one is a true description of the same fault."""
import dataclasses
import os
import signal
import subprocess
import time
from typing import Callable

from operator_actions import (abuse_parameters, bad_requests, disable, disable_with_open_brake, fill_disk, flood, load_while_playing,
                              press_service, remove_recordings_folder, replace_file, says_disk_is_full, start_twice)
from session import NoAnswer, is_alive

# What is to come of a fault.
SAFE_STOP = "safe stop, faulted"  # the controller lives and says why
DOWN = "guardian brings down"     # the controller is dead or fenced out
DISABLED = "safe stop, disabled"  # asked for
GOES_ON = "goes on"               # nothing may happen to the movement
CARRIED = "the drives carry on"   # a brake slipped: safe_stopping with its fault until somebody supports the platform
STRANDED = "outputs cannot be written"  # the controller says so and keeps the last force; the brakes are the heartbeat relay's, where there is one


@dataclasses.dataclass
class Fault:
    name: str
    do: Callable                      # do(run): brings it about; run.at_injection() notes the time where the truth log does not
    outcome: str = SAFE_STOP
    causes: tuple = ()                # names of which one has to be reported; () with GOES_ON and DISABLED: none may be
    process_death: bool = False       # counts for the 20 ms after a death
    brakes_can_be_ordered: bool = True  # somebody is left who can; counts for the targets all the same
    after: Callable = None            # after(run): further checks; returns a sentence about what is wrong, or None
    hardware: dict = dataclasses.field(default_factory=dict)    # changes to the hardware file
    simulation: dict = dataclasses.field(default_factory=dict)  # changes to the simulation file
    fresh: bool = False               # needs a robot of its own
    observe_s: float = 2.5
    at_rest: bool = False             # holding instead of playing
    on_can: bool = False              # the robot stands behind drives on a CAN bus instead of cards


def inject(kind, axis=0, size=0.0):
    return lambda run: run.session.inject(kind, axis, size)


def component(part, misbehaviour):
    return inject("component", size=100 * part + misbehaviour)


def send(*signals, wait_s=0.0, process="controller"):
    """The signals one after the other, `wait_s` between."""
    def do(run):
        target = getattr(run.session, process)
        run.at_injection()
        for k, one in enumerate(signals):
            if k > 0:
                time.sleep(wait_s)
            os.kill(target.pid, one)
    return do


# ---- processes

# A retriggerable relay on the heartbeat output, as hardware files declare one: without it the counter card's outputs are the last word.
RELAY = {"heartbeat_relay": {"bit": 2, "hold_s": 0.02}}
# The drives' ready outputs in series on a digital input, as the machine page wires them.
READY = {"digital_inputs": {"emergency_stop_clear": 0, "hand_switch_clear": 1, "drives_ready": 2}}


def kill_guardian(run):
    run.at_injection()
    run.session.guardian.kill()
    run.session.guardian.wait()


def restart_guardian(run):
    """As a service manager does; until then the robot may not be enabled."""
    if run.session.trigger("enable").success:
        return "it may be enabled without a guardian"
    run.session.start_guardian()
    time.sleep(0.5)
    answer = run.session.trigger("reset_faults")
    return None if answer.success else f"not to be reset with the guardian back: {answer.message}"


def kill_both(run):
    kill_guardian(run)
    time.sleep(0.05)
    run.at_injection()
    run.session.controller.kill()
    run.session.controller.wait()


def guardian_again(run):
    """As launch file and service manager see to."""
    run.session.start_guardian()
    time.sleep(0.5)
    return None if run.session.guardian.poll() is None else "the guardian did not come up again"


def stop_guardian_for_a_while(run):
    run.at_injection()
    os.kill(run.session.guardian.pid, signal.SIGSTOP)
    time.sleep(1.5)
    os.kill(run.session.guardian.pid, signal.SIGCONT)


def fenced_out(run):
    """After SIGCONT: refused until reset."""
    try:
        if run.session.trigger("enable").success:
            return "it may be enabled without a reset"
    except NoAnswer as error:
        return str(error)
    return None


def kill_master(run):
    run.session.keep_connections()
    run.at_injection()
    run.master.stop()


def restart_master(run):
    run.master.start()
    run.session_is_spent = True  # its services are not registered any more
    return None


def stop_master_for_a_moment(run):
    run.at_injection()
    os.kill(run.master.process.pid, signal.SIGSTOP)
    time.sleep(0.8)
    os.kill(run.master.process.pid, signal.SIGCONT)


def second_controller(run):
    """Another controller on the same robot: has to end by itself with a sentence."""
    run.at_injection()
    command = run.session.controller_command(name="second_controller", program="controller")
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=25, check=False)
    run.note = (done.stderr.strip().splitlines() or [""])[-1]
    if done.returncode != 2:
        run.wrong = f"the second controller ended with {done.returncode}"


def second_robot(run):
    run.at_injection()
    files = run.session.files
    done = subprocess.run([str(run.session.programs / "simulated_robot"), "--robot", str(files["robot"]), "--simulation",
                           str(files["simulation"]), "--shm", run.session.shm, "--duration", "1"],
                          capture_output=True, text=True, timeout=25, check=False)
    run.note = (done.stderr.strip().splitlines() or [""])[-1]
    if done.returncode != 2:
        run.wrong = f"the second simulated robot ended with {done.returncode}"


def second_guardian(run):
    run.at_injection()
    files = run.session.files
    done = subprocess.run([str(run.session.programs / "guardian"), "--hardware", str(files["hardware"]), "--shm", run.session.shm,
                           "--link", run.session.shm + "_guardian"], capture_output=True, text=True, timeout=25, check=False)
    run.note = (done.stderr.strip().splitlines() or [""])[-1]
    if done.returncode != 2:
        run.wrong = f"the second guardian ended with {done.returncode}"


# ---- the list

def per_channel():
    causes = {"frozen": ("encoder_frozen", "following_error", "stalled"),
              "jump": ("encoder_jump",),
              "wrong_sign": ("runaway", "following_error", "encoder_frozen", "velocity_limit"),
              "noise": ("encoder_jump", "acceleration_limit", "velocity_limit"),
              "disconnected": ("encoder_frozen", "encoder_jump", "following_error", "stalled")}  # open inputs go to and fro
    size = {"jump": 0.005, "noise": 0.002}
    for kind, names in causes.items():
        for axis in range(1, 5):
            yield Fault(f"encoder_{kind}_{axis}", inject("encoder_" + kind, axis, size.get(kind, 0.0)), causes=names)
    for axis in range(1, 5):
        yield Fault(f"dac_stuck_{axis}", inject("converter_stuck", axis), causes=("following_error", "runaway", "saturated", "stalled",
                                                                                 "velocity_limit", "acceleration_limit", "axis_blocked"))


def processes():
    died = dict(outcome=DOWN, causes=("has died", "is silent"), process_death=True)
    yield Fault("controller_killed", send(signal.SIGKILL), **died)
    yield Fault("controller_aborted", send(signal.SIGABRT), **died)
    yield Fault("controller_segmentation_fault", send(signal.SIGSEGV), **died)
    yield Fault("controller_stopped", send(signal.SIGSTOP), **dict(died, causes=("is silent",)))
    yield Fault("controller_stopped_and_continued", send(signal.SIGSTOP, signal.SIGCONT, wait_s=0.8), outcome=SAFE_STOP,
                causes=("guardian_acted",), process_death=True, after=fenced_out)
    yield Fault("controller_terminated", send(signal.SIGTERM), outcome=DISABLED)
    yield Fault("controller_interrupted", send(signal.SIGINT), outcome=DISABLED)
    yield Fault("guardian_killed", kill_guardian, causes=("guardian_silent",), after=restart_guardian, observe_s=1.6)
    yield Fault("guardian_stopped_for_a_while", stop_guardian_for_a_while, causes=("guardian_silent",), observe_s=0.5)
    # The guardian's heir acts in these two.
    yield Fault("guardian_killed_then_controller", kill_both, outcome=DOWN, causes=("has died",), process_death=True, after=guardian_again,
                fresh=True, observe_s=3.0)
    yield Fault("guardian_killed_then_controller_with_relay", kill_both, outcome=DOWN, causes=("has died", "none"), process_death=True,
                fresh=True, simulation=RELAY)
    yield Fault("master_killed", kill_master, outcome=DISABLED, after=restart_master, observe_s=6.0)  # after master_timeout_s
    yield Fault("master_silent_for_a_moment", stop_master_for_a_moment, outcome=GOES_ON, observe_s=0.6)
    yield Fault("second_controller", second_controller, outcome=GOES_ON, observe_s=0.3)
    yield Fault("second_simulated_robot", second_robot, outcome=GOES_ON, observe_s=0.3)
    yield Fault("second_guardian", second_guardian, outcome=GOES_ON, observe_s=0.3)
    yield Fault("clock_step_forward", inject("component", size=901), outcome=GOES_ON, observe_s=0.8)
    yield Fault("clock_step_backward", inject("component", size=902), outcome=GOES_ON, observe_s=0.8)


def components():
    exception = dict(causes=("component_exception",))
    for number, part in ((1, "sync"), (2, "driver"), (3, "supervisor"), (4, "axes_output"), (5, "axes_input"), (6, "recorder")):
        yield Fault(f"exception_in_{part}", component(number, 1), **exception)
    hang = dict(outcome=DOWN, causes=("is silent",), process_death=True, fresh=True)
    for number, part in ((1, "sync"), (2, "driver")):
        yield Fault(f"hang_in_{part}", component(number, 2), **hang)
    yield Fault("fatal_in_driver", component(2, 3), causes=("component_fatal",), fresh=True)
    yield Fault("run_time_error_in_driver", component(2, 9), causes=("component_stopped",))
    yield Fault("sync_stale", component(1, 4), causes=("set_point_stale",))
    yield Fault("driver_stale", component(2, 4), causes=("command_stale",))
    yield Fault("supervisor_stale", component(3, 4), causes=("orders_stale",))
    yield Fault("reference_nan", component(1, 5), causes=("not_a_number",))
    yield Fault("reference_jump", component(1, 6), causes=("set_point_jump",))
    yield Fault("command_nan", component(2, 5), causes=("not_a_number",))
    yield Fault("command_of_1000_V", component(2, 6), causes=("following_error", "runaway", "velocity_limit", "acceleration_limit",
                                                             "saturated"))
    yield Fault("overrun_storm", component(2, 8), causes=("overrun",))
    yield Fault("slow_card", inject("slow_card", size=1800), causes=("overrun",))


def machine():
    yield Fault("dac_write_error", inject("analog_card_lost"), causes=("output_lost",))
    yield Fault("counter_card_lost", inject("counter_card_lost"), causes=("output_lost", "measurement_lost"), outcome=STRANDED, brakes_can_be_ordered=False)
    yield Fault("counter_card_lost_with_relay", inject("counter_card_lost"), causes=("output_lost", "measurement_lost"), outcome=STRANDED,
                fresh=True, simulation=RELAY)
    yield Fault("drive_power_lost", inject("drive_dead"), causes=("following_error", "stalled", "runaway", "velocity_limit",
                                                                  "acceleration_limit"))
    yield Fault("drive_power_lost_1", inject("drive_dead", 1), causes=("following_error", "stalled", "runaway", "velocity_limit",
                                                                      "acceleration_limit", "axis_blocked"))
    for name, axis in (("drive_power_lost_with_ready_line", 0), ("drive_power_lost_1_with_ready_line", 1)):
        yield Fault(name, inject("drive_dead", axis), causes=("drives_not_ready",), fresh=True, hardware=READY)
    yield Fault("drive_reversed_2", inject("drive_reversed", 2), causes=("runaway", "following_error", "velocity_limit",
                                                                        "acceleration_limit", "saturated"))
    yield Fault("brake_closes_3", inject("hold_closed", 3), causes=("axis_blocked", "following_error", "stalled", "saturated", "acceleration_limit"))
    yield Fault("brake_does_not_engage_4", disable_with_open_brake(4), outcome=CARRIED, causes=("hold_device_slips",), fresh=True)
    yield Fault("no_brake_engages", disable_with_open_brake(0), outcome=CARRIED, causes=("hold_device_slips",), fresh=True)
    yield Fault("emergency_stop_button", inject("emergency_stop"), causes=("emergency_stop",))
    yield Fault("hand_switch", inject("hand_switch"), causes=("hand_switch",))
    yield Fault("push_down_800_N", inject("push_down", size=800.0), causes=("following_error", "saturated", "velocity_limit",
                                                                          "acceleration_limit", "runaway", "stalled"))


def then_push(fault, axis, newton, wait_s):
    """A fault at rest, and a push on the platform `wait_s` later."""
    def do(run):
        run.session.inject(fault, axis)
        time.sleep(wait_s)
        run.session.inject("push_down", size=newton)
    return do


def at_rest():
    """Holding: what stands still hides a fault, until something disturbs it."""
    for axis in range(1, 5):
        for wait_s, when in ((2.5, "then"), (0.02, "at_once")):
            yield Fault(f"encoder_frozen_{axis}_at_rest_{when}_150_N", then_push("encoder_frozen", axis, 150.0, wait_s),
                        causes=("encoder_frozen",), at_rest=True, observe_s=4.0)
    yield Fault("brake_closed_3_at_rest_then_150_N", then_push("hold_closed", 3, 150.0, 1.0), causes=("axis_blocked", "encoder_frozen", "stalled"),
                at_rest=True, observe_s=4.0)
    yield Fault("drive_power_lost_at_rest", inject("drive_dead"), causes=("following_error", "stalled", "runaway", "velocity_limit",
                                                                          "acceleration_limit"), at_rest=True)
    yield Fault("drive_power_lost_at_rest_with_ready_line", inject("drive_dead"), causes=("drives_not_ready",), at_rest=True, fresh=True,
                hardware=READY)
    yield Fault("emergency_stop_button_at_rest", inject("emergency_stop"), causes=("emergency_stop",), at_rest=True)
    yield Fault("counter_card_lost_at_rest", inject("counter_card_lost"), causes=("output_lost", "measurement_lost"), outcome=STRANDED,
                brakes_can_be_ordered=False, at_rest=True, fresh=True)
    yield Fault("analog_card_lost_at_rest", inject("analog_card_lost"), causes=("output_lost",), at_rest=True)
    yield Fault("controller_killed_at_rest", send(signal.SIGKILL), outcome=DOWN, causes=("has died", "is silent"), process_death=True,
                at_rest=True)
    yield Fault("controller_killed_at_rest_with_relay", send(signal.SIGKILL), outcome=DOWN, causes=("has died", "is silent"), process_death=True,
                at_rest=True, fresh=True, simulation=RELAY)
    yield Fault("counter_card_silent_at_rest", inject("counter_card_silent"), causes=("output_lost", "measurement_lost"), outcome=STRANDED,
                brakes_can_be_ordered=False, at_rest=True, fresh=True)
    yield Fault("controller_stopped_at_rest", send(signal.SIGSTOP), outcome=DOWN, causes=("is silent",), process_death=True, at_rest=True)
    yield Fault("guardian_killed_at_rest", kill_guardian, causes=("guardian_silent",), after=restart_guardian, at_rest=True, observe_s=1.6)


def operator():
    yield Fault("emergency_stop_service", press_service, causes=("emergency_stop",))
    yield Fault("disable_while_moving", disable, outcome=DISABLED)
    yield Fault("second_start", start_twice, outcome=GOES_ON, observe_s=0.3)
    yield Fault("load_while_playing", load_while_playing, outcome=GOES_ON, observe_s=0.3)
    yield Fault("file_replaced_while_playing", replace_file, outcome=GOES_ON, observe_s=0.8)
    yield Fault("service_flood", flood, outcome=GOES_ON, observe_s=0.2)
    yield Fault("bad_requests", bad_requests, outcome=GOES_ON, observe_s=0.2)
    yield Fault("parameter_abuse", abuse_parameters, outcome=GOES_ON, observe_s=0.6)
    yield Fault("recordings_folder_moved", remove_recordings_folder, outcome=GOES_ON, observe_s=0.2)


def disk_full():
    return Fault("disk_full_while_recording", fill_disk, outcome=GOES_ON, observe_s=1.2, after=says_disk_is_full)


def on_can_drives():
    """docs/can.md. The controller's own heartbeat is lost with the wire cut: the drives stop by themselves."""
    faults = [("can_silent", 2, ("drive_lost", "drive_heartbeat_lost")), ("can_no_heartbeat", 4, ("drive_heartbeat_lost",)),
              ("can_drive_fault", 2, ("drive_fault",)), ("can_emergency", 3, ("drive_emergency",)),
              ("can_cut", 0, ("drive_lost", "drive_heartbeat_lost", "controller_heartbeat_lost")),
              ("can_delayed", 0, ("feedback_late",)), ("can_reordered", 0, ("feedback_late",)),
              ("can_flooded", 0, ("bus_flooded",)), ("can_bus_off", 0, ("bus_off",)),
              ("can_hung_up", 0, ("bus_down",))]
    for name, axis, causes in faults:
        yield Fault(name, inject(name, axis), causes=causes, on_can=True, fresh=name in ("can_hung_up", "can_cut", "can_bus_off"))
    yield Fault("can_controller_killed", send(signal.SIGKILL), outcome=DOWN, causes=("has died", "is silent"), process_death=True,
                on_can=True, fresh=True)


def all_faults():
    # Quick ones that leave the robot usable first: their sessions are shared.
    faults = [*operator(), *machine(), *at_rest(), *per_channel(), *components(), *processes(), disk_full(), *on_can_drives()]
    return sorted(faults, key=lambda fault: (fault.on_can, fault.fresh))


__all__ = ["all_faults", "Fault", "is_alive", "SAFE_STOP", "DOWN", "DISABLED", "GOES_ON", "CARRIED", "STRANDED"]
