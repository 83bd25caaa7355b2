"""What the fleet's tests share: programs, one small simulated robot, an engine of two workers."""
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
sys.dont_write_bytecode = True

from fleet import machines  # noqa: E402
from fleet.engine import Engine  # noqa: E402
from fleet.programs import default_programs  # noqa: E402


@pytest.fixture(scope="session")
def programs():
    folder = pathlib.Path(os.environ.get("KNEE_PROGRAMS", default_programs()))
    if not (folder / "simulate").exists():
        pytest.skip(f"{folder} has no programs: run scripts/build")
    return folder


@pytest.fixture(scope="session")
def engine():
    with Engine(workers=2) as running:
        yield running


@pytest.fixture(scope="session")
def recordings(programs, tmp_path_factory):
    """Folder of one simulated robot with four sessions on one movement; the last one has 25 % more friction in leg 2."""
    folder = tmp_path_factory.mktemp("simulated")
    machines.plan_references(programs, folder)
    steady = machines.Machine(7001, "wear", "A", machines.GAINS[0], tuple(machines.FRICTION), 2, 6, 0, 0.25, ())
    for week in (0, 2, 4, 6):
        machines.write_session(steady, week, str(programs), str(folder))
    robot = folder / "recordings" / steady.name
    (robot / "robot.yaml").write_text((ROOT / "config/robots/A.yaml").read_text().replace("../../urdf", str(ROOT / "urdf")))
    return folder / "recordings"
