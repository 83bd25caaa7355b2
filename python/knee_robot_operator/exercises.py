"""The exercise list: what each reference file looks like and how near it comes to the limits, by the program check_reference."""
import asyncio
import collections
import json
import os

from .answer import Refused
from .out_of_memory import yielding

_MOST_REMEMBERED = 200
_LONGEST_S = 30.0
_LARGEST_ANSWER = 2_000_000


class Exercises:
    """Pictures and margins are computed once per version of a file, one file at a time and at low priority."""

    def __init__(self, folder, robot_file, program):
        """`program`: the path of check_reference."""
        self.folder, self._robot_file, self._program = folder, robot_file, program
        self._known = collections.OrderedDict()
        self._one_at_a_time = asyncio.Lock()

    async def picture(self, name):
        """{points, duration_s, margins, violation, path} as check_reference --json prints it; Refused when it cannot."""
        path = self.folder.existing(name)
        status = path.stat()
        key = (name, status.st_mtime_ns, status.st_size)
        async with self._one_at_a_time:
            if key not in self._known:
                self._known[key] = await self._look(path)
                while len(self._known) > _MOST_REMEMBERED:
                    self._known.popitem(last=False)
        return self._known[key]

    async def _look(self, path):
        process = await asyncio.create_subprocess_exec(
            self._program, str(path), "--robot", self._robot_file, "--json", stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE, limit=_LARGEST_ANSWER, preexec_fn=yielding)
        try:
            out, error = await asyncio.wait_for(process.communicate(), _LONGEST_S)
        except asyncio.TimeoutError:
            process.kill()
            await process.wait()
            raise Refused(503, f"{path.name} could not be checked within {_LONGEST_S:g} s") from None
        try:
            found = json.loads(out)
        except ValueError:
            found = {"violation": error.decode(errors="replace").strip() or f"{path.name} could not be checked", "margins": [], "path": None}
        if found.get("violation"):
            found["violation"] = self._without_paths(found["violation"], path)
        return found

    def _without_paths(self, sentence, path):
        """Where the files lie on the robot's computer says nothing to who stands beside it."""
        for one in (str(path), str(self._robot_file)):
            sentence = sentence.replace(one, os.path.basename(one))
        return sentence.removeprefix("check_reference: ")
