"""Every task ends once, whatever happens to the workers."""
import os
import signal
import threading
import time

import work_for_tests as w

from fleet.engine import Engine, Task


def test_every_task_is_yielded_once_with_its_value(engine):
    ended = list(engine.run(Task(f"double {k}", w.double, (k,)) for k in range(100)))
    assert sorted(d.value for d in ended) == [2 * k for k in range(100)]


def test_an_exception_costs_its_own_task_only(engine):
    ended = {d.task.name: d for d in engine.run([Task("bad", w.fail, ("line 3: no number",)), Task("good", w.double, (1,))])}
    assert ended["bad"].sentence == "line 3: no number" and ended["good"].value == 2


def test_what_became_possible_is_done_too(engine):
    def then(done):
        return [Task("second", w.double, (done.value,))] if done.task.name == "first" else []

    assert [d.value for d in engine.run([Task("first", w.double, (1,))], then)] == [2, 4]


def test_nothing_is_lost_and_nothing_reported_twice_when_workers_are_killed(tmp_path):
    with Engine(workers=2) as engine:
        ended, victims = [], engine.worker_processes()
        killer = threading.Timer(0.5, lambda: [os.kill(v, signal.SIGKILL) for v in victims])
        killer.start()
        for done in engine.run(Task(f"mark {k}", w.leave_a_mark, (str(tmp_path), str(k), 0.02)) for k in range(150)):
            ended.append(done)
        killer.join()
        assert not set(victims) & set(engine.worker_processes()), "the workers were not killed"
    assert not [d.sentence for d in ended if d.sentence]
    assert sorted(d.value for d in ended) == sorted(str(k) for k in range(150))
    assert len(list(tmp_path.iterdir())) == 150


def test_a_task_that_kills_every_worker_is_given_up_and_the_others_are_done():
    with Engine(workers=2) as engine:
        tasks = [Task("deadly", w.die, (0,))] + [Task(f"double {k}", w.double, (k,)) for k in range(20)]
        ended = {d.task.name: d for d in engine.run(tasks)}
    assert "its worker died" in ended["deadly"].sentence
    assert len([d for d in ended.values() if not d.sentence]) >= 18  # what shared a worker with it may be given up too


def test_only_a_window_of_tasks_is_in_flight(engine):
    taken = []

    def tasks():
        for k in range(200):
            taken.append(k)
            yield Task(f"double {k}", w.double, (k,))

    running = engine.run(tasks())
    next(running)
    time.sleep(0.1)
    assert len(taken) <= 10
    assert len(list(running)) == 199
