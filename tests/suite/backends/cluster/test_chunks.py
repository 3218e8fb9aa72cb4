from collections import Counter
from dataclasses import replace

from fakes import behave, make_tasks
from hypothesis import given, settings
from hypothesis import strategies as st

from planners.failure import Failure
from suite.backends.agenda import TRIES
from suite.backends.cluster.chunks import AIM_S, FIRST, MOST, Chunk, Chunks
from suite.trial.task import TrialResult, TrialTask


def result_of(task: TrialTask, took_s: float = 0.01) -> TrialResult:
    result = behave(task)
    return result._replace(row=result.row | {"trial_wall_s": took_s})


def all_of(chunk: Chunk, took_s: float = 0.01) -> dict[int, TrialResult]:
    return {place: result_of(task, took_s) for place, task in enumerate(chunk.tasks)}


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_whatever_comes_back_every_task_has_one_result(data: st.DataObject) -> None:
    """Chunks come back in any order: whole, in part, not at all; one planner takes every worker down with it."""
    tasks = make_tasks(["a", "b"], trials=data.draw(st.integers(1, 12)))
    killers = data.draw(st.sets(st.sampled_from([task.key for task in tasks]), max_size=2))
    chunks, out, found = Chunks(tasks), list[Chunk](), Counter[str]()
    while chunks.n_open:
        while len(out) < 3 and (chunk := chunks.next_chunk(slots=2)):
            out.append(chunk)
        if out:
            chunk = out.pop(data.draw(st.integers(0, len(out) - 1)))
            fate = data.draw(st.sampled_from(["whole", "part", "lost"])) if len(chunk.tasks) > 1 else "whole"
            if fate == "lost" or killers & {task.key for task in chunk.tasks}:
                chunks.lost(chunk, "its worker died")
            else:
                kept = all_of(chunk)
                if fate == "part":
                    kept = {
                        place: kept[place] for place in data.draw(st.sets(st.sampled_from(sorted(kept)), min_size=1))
                    }
                chunks.came_back(chunk, kept)
        for task, result in chunks.results():
            found[task.key] += 1
            assert (result.row["outcome"] == "worker_lost") == (task.key in killers)
    assert found == Counter(task.key for task in tasks)
    assert not out
    assert chunks.next_chunk(slots=2) is None


def test_a_lost_chunk_goes_again_trial_by_trial() -> None:
    tasks = make_tasks(["a"], trials=FIRST)
    chunks = Chunks(tasks)
    chunk = chunks.next_chunk(slots=1)
    assert chunk is not None
    assert len(chunk.tasks) == FIRST
    chunks.lost(chunk, "its worker died")
    alone = [chunks.next_chunk(slots=1) for _ in tasks]
    assert [one.tasks for one in alone if one] == [(task,) for task in tasks]
    assert len({one.number for one in (chunk, *alone) if one}) == FIRST + 1  # a key is never used twice


def test_a_trial_that_is_lost_a_few_times_is_worker_lost() -> None:
    chunks = Chunks(make_tasks(["a"]))
    for _ in range(TRIES):
        chunk = chunks.next_chunk(slots=1)
        assert chunk is not None
        chunks.lost(chunk, "its worker died")
    ((_, result),) = chunks.results()
    assert (result.row["outcome"], result.row["message"]) == ("worker_lost", "3 times: its worker died")


def test_nothing_back_is_a_loss() -> None:
    chunks = Chunks(make_tasks(["a"]))
    for _ in range(TRIES):
        chunk = chunks.next_chunk(slots=1)
        assert chunk is not None
        chunks.came_back(chunk, {})
    assert [result.row["outcome"] for _, result in chunks.results()] == ["worker_lost"]


def test_chunks_take_about_as_long_as_they_should_and_less_towards_the_end() -> None:
    chunks = Chunks(make_tasks(["a"], trials=1000))
    sizes = []
    while chunk := chunks.next_chunk(slots=2):
        sizes.append(len(chunk.tasks))
        chunks.came_back(chunk, all_of(chunk, took_s=1.0))
    assert sizes[0] == FIRST
    assert max(sizes) == int(AIM_S)
    assert sizes[-1] == 1
    assert sum(sizes) == 1000


def test_chunks_of_trials_that_take_no_time_are_bounded() -> None:
    chunks = Chunks(make_tasks(["a"], trials=5 * MOST))
    first = chunks.next_chunk(slots=1)
    assert first is not None
    chunks.came_back(first, all_of(first, took_s=1e-6))
    second = chunks.next_chunk(slots=1)
    assert second is not None
    assert len(second.tasks) == MOST


def test_planners_that_cannot_be_imported_are_not_sent() -> None:
    failure = Failure("planner_error", "in import: no")
    good, bad = make_tasks(["a", "b"])
    chunks = Chunks([replace(bad, spec=bad.spec._replace(failure=failure)), good])
    chunk = chunks.next_chunk(slots=1)
    assert chunk is not None
    assert chunk.tasks == (good,)
    assert [result.row["message"] for _, result in chunks.results()] == ["in import: no"]
