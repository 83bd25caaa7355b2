"""The controller as the page sees it, over ROS: its state, its services, its action. The only module that knows rospy."""
import asyncio
import math
import threading
import time

import actionlib
import rosgraph
import rospy
import rosservice
from actionlib_msgs.msg import GoalStatus
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger

from knee_robot.msg import ControllerState, Event, Forces, Margins, PlayAction, PlayGoal, Tracking
from knee_robot.srv import CheckReference, GetEvents, GetState, LoadPatient, LoadReference, SetSpeed

from .answer import Answer
from .controller_events import ControllerEvents

SILENT_S = 2.0     # the state comes twice a second
_KINDS = {"load_reference": LoadReference, "check_reference": CheckReference, "set_speed": SetSpeed, "load_patient": LoadPatient,
          "get_state": GetState, "get_events": GetEvents}
_PATIENCE_S = {"enable": 30.0, "disable": 15.0, "check_reference": 30.0, "load_reference": 30.0}
_MOST_THREADS = 40
# Asked for again at once where the connection breaks off: roscpp loses one call in about ten thousand while several clients call without a pause.
_HARMLESS_TWICE = ("stop", "pause", "disable", "emergency_stop", "get_state", "get_events")


def _state_dict(message):
    names = ("state", "fault", "cause", "reference_file", "patient", "playing", "at_start", "duration_s", "path_time_s", "progress", "time_scale",
             "speed_percent", "recording")
    state = {name: getattr(message, name) for name in names}
    state["homed"] = all(message.homed)
    # unknown, patient or empty; "" by a controller that does not ask who is on the robot before anything moves
    state["occupancy"] = getattr(message, "occupancy", "")
    return state


def _event_dict(message):
    return {"number": message.number, "time": round(message.header.stamp.to_sec(), 3), "kind": message.kind, "who": message.who, "what": message.what,
            "answer": message.answer}


class RosRobot:
    """`loop`: the server's. Messages are kept as they come; listeners are called on the loop."""

    def __init__(self, loop, controller="controller"):
        self._loop, self._name = loop, rospy.resolve_name(controller)
        self._threads = threading.BoundedSemaphore(_MOST_THREADS)
        self._listeners, self._log_listeners, self._event_listeners = [], [], []
        self._events = ControllerEvents(self._fetch_events, self._tell_event)
        self._state = self._tracking = self._forces = self._margins = None
        self._heard = -math.inf
        self._warned_of_others = False
        self._goal = None
        self._cancels = 0  # a goal that is just being sent is cancelled, too
        name = self._name
        self._subscribers = [
            rospy.Subscriber(f"{name}/state", ControllerState, self._on_state, queue_size=10),
            rospy.Subscriber(f"{name}/tracking", Tracking, lambda m: self._keep("_tracking", m), queue_size=1),
            rospy.Subscriber(f"{name}/forces", Forces, lambda m: self._keep("_forces", m), queue_size=1),
            rospy.Subscriber(f"{name}/margins", Margins, lambda m: self._keep("_margins", m), queue_size=1),
            rospy.Subscriber(f"{name}/events", Event, self._on_event, queue_size=200),
            rospy.Subscriber("/rosout", Log, self._on_log, queue_size=50)]
        self._client = actionlib.ActionClient(f"{name}/play", PlayAction)

    def listen(self, on_state, on_log, on_event):
        """`on_state(state)` after every state message, `on_event(event, is_ours)` for every entry of the controller's event log, `on_log(sentence)`
        for its warnings."""
        self._event_listeners.append(on_event)
        self._listeners.append(on_state)
        self._log_listeners.append(on_log)

    def parameter(self, name, default=None):
        return rospy.get_param(f"{self._name}/{name}", default)

    @property
    def silent(self):
        return time.monotonic() - self._heard > SILENT_S

    @property
    def state(self):
        """The newest state as a dict; None while the controller is silent."""
        return None if self.silent else self._state

    async def fresh_state(self):
        """Asked for just now, not the newest that has come by itself; None without an answer."""
        try:
            message = await self._call("get_state", 2.0)
        except (asyncio.TimeoutError, rospy.ServiceException, rospy.ROSException, OSError):
            return None
        return self._remember(message.state)

    def live(self):
        """What the plots show, rounded: mm and N per actuator; None before the first messages."""
        tracking, forces, margins = self._tracking, self._forces, self._margins
        if tracking is None or forces is None:
            return None
        millimetres = [[round(1e3 * v, 3) for v in values] for values in (tracking.reference_m, tracking.position_m)]
        live = {"t": round(tracking.header.stamp.to_sec(), 3), "reference": millimetres[0], "position": millimetres[1],
                "force": [round(v, 2) for v in tracking.force_N],
                "residual": [round(f - m, 2) for f, m in zip(forces.force_N, forces.feedforward_N)],
                "heat": round(max(forces.thermal), 3)}
        if margins is not None:
            live.update(nearest=margins.nearest, left=round(margins.nearest_left, 3))
        return live

    async def ask(self, service, **fields):
        """One service call on a thread of its own. Raises nothing but asyncio.TimeoutError."""
        try:
            answer = await self._call(service, _PATIENCE_S.get(service, 10.0), **fields)
        except (rospy.ServiceException, rospy.ROSException, rosservice.ROSServiceException, OSError) as error:
            return Answer(False, f"the controller cannot be asked to {service.replace('_', ' ')} ({error})")
        return Answer(bool(answer.success), answer.message)

    async def offers(self, service):
        def look():
            try:
                return bool(rosgraph.Master(rospy.get_name()).lookupService(f"{self._name}/{service}"))
            except (rosgraph.MasterError, OSError):
                return False
        return await self._loop.run_in_executor(None, look)

    async def play(self, speed_percent, recording, on_begin):
        """Plays the loaded reference once through the action `play`; answers when it has ended. `on_begin` when the robot has set off: a
        goal that is accepted may still be refused where it would begin."""
        done = self._loop.create_future()
        cancels = self._cancels

        def transition(handle):
            if handle.get_comm_state() == actionlib.CommState.DONE:
                result = handle.get_result()
                sentence = (result.message if result else "") or handle.get_goal_status_text() or "no result came"
                answer = Answer(handle.get_terminal_state() == GoalStatus.SUCCEEDED, sentence)
                self._loop.call_soon_threadsafe(lambda: done.done() or done.set_result(answer))

        def feedback(_handle, message):
            if message.phase == "playing":
                self._loop.call_soon_threadsafe(on_begin)

        def send():
            if not self._client.wait_for_server(rospy.Duration(5.0)):
                raise rospy.ROSException("no action server")
            if self._cancels != cancels:
                return None
            goal = PlayGoal(speed_percent=speed_percent, record=bool(recording), recording=recording)
            self._goal = self._client.send_goal(goal, transition_cb=transition, feedback_cb=feedback)
            if self._cancels != cancels:
                self._goal.cancel()
            return self._goal

        try:
            if await self._on_thread(send) is None:
                return Answer(False, "stopped before it began")
            while not done.done():
                await asyncio.wait({done}, timeout=0.5)
                if self.silent:
                    return Answer(False, "the controller fell silent")
            return done.result()
        except rospy.ROSException:
            return Answer(False, f"there is no action {self._name}/play; does the controller run?")
        finally:
            self._goal = None

    def cancel_play(self):
        """The goal that this page has sent or is just sending, if any; never waits."""
        self._cancels += 1
        goal = self._goal
        if goal is not None:
            threading.Thread(target=goal.cancel, daemon=True).start()

    def _call(self, service, patience_s, **fields):
        kind = _KINDS.get(service, Trigger)

        def work():
            try:
                return rospy.ServiceProxy(f"{self._name}/{service}", kind)(**fields)
            except rospy.ServiceException as error:
                if service not in _HARMLESS_TWICE or "transport error" not in str(error):
                    raise
            return rospy.ServiceProxy(f"{self._name}/{service}", kind)(**fields)

        return asyncio.wait_for(self._on_thread(work), patience_s)

    def _on_thread(self, work):
        """A thread of its own: a call that hangs takes none from the next, which may be STOP. At most _MOST_THREADS hang."""
        future = self._loop.create_future()
        if not self._threads.acquire(blocking=False):
            future.set_exception(rospy.ROSException("too many calls wait for the controller"))
            return future

        def settle(result, error):
            if future.done():
                return
            future.set_exception(error) if error else future.set_result(result)

        def run():
            result = error = None
            try:
                result = work()
            except Exception as failure:  # handed to who waits for it
                error = failure
            finally:
                self._threads.release()
            try:
                self._loop.call_soon_threadsafe(settle, result, error)
            except RuntimeError:
                pass  # the server has ended meanwhile

        threading.Thread(target=run, daemon=True).start()
        return future

    def _is_controllers(self, message):
        """False: from somebody else on the controller's topics, such as a bag that is played beside the robot."""
        sender = (getattr(message, "_connection_header", None) or {}).get("callerid", self._name)
        if sender != self._name and not self._warned_of_others:
            self._warned_of_others = True
            rospy.logwarn("%s publishes states in the name of %s (is a bag being played?): not shown", sender, self._name)
        return sender == self._name

    def _keep(self, kind, message):
        if self._is_controllers(message):
            setattr(self, kind, message)

    def _on_event(self, message):
        if self._is_controllers(message):
            self._loop.call_soon_threadsafe(self._events.hear, _event_dict(message))

    def _remember(self, message):
        self._state, self._heard = _state_dict(message), time.monotonic()
        return self._state

    def _on_state(self, message):
        if not self._is_controllers(message):
            return
        self._remember(message)
        for listener in self._listeners:
            self._loop.call_soon_threadsafe(listener, self._state)

    def _on_log(self, message):
        if message.name == self._name and message.level >= Log.WARN:
            for listener in self._log_listeners:
                self._loop.call_soon_threadsafe(listener, message.msg)

    async def _fetch_events(self, after):
        try:
            answer = await self._call("get_events", 5.0, after=after)
        except (asyncio.TimeoutError, rospy.ServiceException, rospy.ROSException, OSError):
            return None
        return [_event_dict(event) for event in answer.events]

    def _tell_event(self, event, is_old):
        """What this server has asked for itself is told by it, with the user's name; not what an earlier one asked for."""
        for listener in self._event_listeners:
            listener(event, not is_old and event["who"] == rospy.get_name())
