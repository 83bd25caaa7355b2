"""Client of the action identify_recordings, for the page's jobs."""
import asyncio
import threading

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus

from knee_robot.msg import IdentifyRecordingsAction, IdentifyRecordingsGoal

from .answer import Answer

_NO_SERVER = "identification does not run (launch/operator.launch starts it)"
_SILENT_S = 10.0  # the server feeds back twice a second


class RosIdentification:
    def __init__(self, loop, robot_file):
        self._loop, self._robot_file = loop, robot_file
        self._client = actionlib.ActionClient("identify_recordings", IdentifyRecordingsAction)
        self._goal = None

    def cancel(self):
        if self._goal is not None:
            threading.Thread(target=self._goal.cancel, daemon=True).start()

    async def run(self, command, train, validate, output, model, feed):
        """(Answer, result as a dict). `feed(stage, share)` on the way. `model`: the one in use, set beside the new one."""
        done = self._loop.create_future()
        heard = [self._loop.time()]

        def transition(handle):
            if handle.get_comm_state() != actionlib.CommState.DONE:
                return
            result = handle.get_result()
            sentence = (result.message if result else "") or handle.get_goal_status_text() or "no result came"
            answer = Answer(handle.get_terminal_state() == GoalStatus.SUCCEEDED, sentence)
            self._loop.call_soon_threadsafe(lambda: done.done() or done.set_result((answer, result)))

        def fed(stage, share):
            heard[0] = self._loop.time()
            feed(stage, share)

        def feedback(_handle, message):
            self._loop.call_soon_threadsafe(fed, message.stage, message.share)

        def send():
            if not self._client.wait_for_server(rospy.Duration(3.0)):
                return None
            goal = IdentifyRecordingsGoal(command=command, robot=self._robot_file, train=train, validate=validate, output=output, model=model)
            return self._client.send_goal(goal, transition_cb=transition, feedback_cb=feedback)

        self._goal = await self._loop.run_in_executor(None, send)
        if self._goal is None:
            return Answer(False, _NO_SERVER), None
        try:
            heard[0] = self._loop.time()
            while not done.done():
                await asyncio.wait({done}, timeout=0.5)
                if self._loop.time() - heard[0] > _SILENT_S:
                    return Answer(False, "identification fell silent; nothing of it was kept"), None
            answer, result = done.result()
            return answer, _as_dict(result) if result else None
        finally:
            self._goal = None


def _as_dict(result):
    lists = {name: [round(v, 4) for v in getattr(result, name)] for name in ("before_rms_N", "after_rms_N", "in_use_rms_N", "new_rms_N")}
    return {**lists, "effects": list(result.effects), "folder": result.folder.rsplit("/", 1)[-1]}
