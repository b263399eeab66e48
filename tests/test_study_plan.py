"""Which runs a study wants: stop rules and searches, from made-up outcomes alone."""

import math
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from parsim.study.plan import Edge, Ended, Sample, Search, Wanted
from parsim.study.statistics import wilson
from parsim.study.table import Bisection, Seeds


def study(seeds=None, bisection=None, near_votes=1):
    """As much of a study as a plan looks at."""
    return SimpleNamespace(seeds=seeds, bisection=bisection, repeats=seeds.most if seeds else 1, near_votes=near_votes)


def search(near_votes=1, seeds=None, **keys):
    keys = {"key": "x", "no": 0.0, "yes": 1.0, "width": 0.1} | keys
    return Search(study(seeds, Bisection(**keys), near_votes), 1, [])


def made(plan, law, jobs=1):
    """Make the runs that a plan wants, `jobs` at a time, the last first; returns them in that order."""
    ended, order = {}, []
    while wanted := [run for run in plan.wanted(ended.get) if run not in ended][:jobs]:
        for run in reversed(wanted):
            assert run not in ended
            ended[run] = Ended(law(run))
            order.append(run)
    return ended, order


def seed(run):
    return int(run.changes[-1].partition("=")[2])


def test_seeds_are_those_of_the_study_in_order():
    plan = Sample(study(Seeds(key="water.disorder", first=0.1, step=0.1, most=3)), 2, ["spacing=0.01"])
    assert plan.wanted(lambda run: None) == [
        Wanted(("spacing=0.01", f"water.disorder={value}"), 2) for value in ("0.1", "0.2", "0.3")
    ]
    assert [Seeds(key="a").value(number) for number in (1, 2)] == [1, 2]


def test_a_row_without_seeds_is_one_run():
    _, order = made(Sample(study(), 1, ["a=1"]), lambda run: 3.0)
    assert order == [Wanted(("a=1",), 1)]


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_probability_is_enough_when_its_interval_is_narrow(jobs):
    plan = Sample(study(Seeds(key="seed", most=100, least=5, within=0.15)), 1, [])
    ended, order = made(plan, lambda run: seed(run) % 4 == 0, jobs)
    enough = next(n for n in range(5, 101) if wilson(n // 4, n).half_width <= 0.15)
    assert enough <= len(order) < enough + jobs and plan.enough(ended.get)


def test_runs_that_failed_do_not_count_and_too_few_are_not_enough():
    seeds = Seeds(key="seed", most=40, least=10, within=0.2)
    _, order = made(Sample(study(seeds), 1, []), lambda run: None if seed(run) <= 8 else False)
    assert len(order) == 18  # ten that count, though nine of one kind would do for 0.2
    _, order = made(Sample(study(seeds), 1, []), lambda run: None)
    assert len(order) == 40


def test_numbers_are_enough_when_their_mean_is():
    plan = Sample(study(Seeds(key="seed", most=50, least=4, within=0.2)), 1, [])
    _, order = made(plan, lambda run: float(seed(run) % 2))
    assert 15 <= len(order) <= 30  # 1.96 * 0.5 / sqrt(n) is 0.2 at 24


def test_what_was_enough_stays_enough():
    plan = Sample(study(Seeds(key="seed", most=12, least=5, within=0.24)), 1, [])
    runs = list(plan.runs())
    ended = {run: Ended(False) for run in runs[:5]} | {run: Ended(seed(run) % 2 == 0) for run in runs[5:10]}
    assert plan.enough(ended.get) and plan.wanted(ended.get) == []
    assert wilson(3, 10).half_width > 0.24
    del ended[runs[3]]  # with a gap nothing is known of what comes after it
    assert plan.wanted(ended.get) == [runs[3], *runs[10:]]


@given(st.floats(0.01, 0.99), st.booleans(), st.integers(1, 3))
@settings(max_examples=60)
def test_a_search_ends_with_the_edge_inside(edge, falling, jobs):
    ends = {"no": 1.0, "yes": 0.0} if falling else {"no": 0.0, "yes": 1.0}
    plan = search(width=0.01, **ends)
    ended, order = made(plan, lambda run: (run.value > edge) != falling, jobs)
    found = plan.edge(ended.get)
    low, high = sorted((found.no, found.yes))
    assert low <= edge <= high and high - low <= 0.01
    assert found.monotone is True and not found.note
    assert len(order) == 2 + math.ceil(math.log2(1.0 / 0.01)) + 1
    assert plan.asked(ended.get) == sorted(order, key=lambda run: run.value)


def test_near_the_edge_three_vote_and_two_that_agree_are_enough():
    seeds = Seeds(key="seed", most=9)
    plan = search(near_votes=3, seeds=seeds, width=0.2, near=2.0, outside=False)
    ended, order = made(plan, lambda run: run.value > 0.6 or (run.value == 0.5 and seed(run) == 2))
    votes = {value: [seed(run) for run in order if run.value == value] for value in (0.0, 1.0, 0.5, 0.75, 0.625)}
    assert votes == {0.0: [1], 1.0: [1], 0.5: [1, 2, 3], 0.75: [1, 2], 0.625: [1, 2]}
    assert (plan.edge(ended.get).no, plan.edge(ended.get).yes) == (0.5, 0.625)


def test_an_end_that_turns_over_near_the_edge_widens_the_search():
    """One run says no at 0.5, three say yes: the edge is below."""
    seeds = Seeds(key="seed", most=9)
    plan = search(near_votes=3, seeds=seeds, width=0.125, near=2.0)
    ended, _ = made(plan, lambda run: run.value > 0.3 and not (run.value == 0.5 and seed(run) == 1))
    found = plan.edge(ended.get)
    assert (found.no, found.yes) == (0.25, 0.375) and not found.wanted


@given(st.integers(0, 10**6), st.sampled_from([1, 3, 5]), st.integers(1, 4))
@settings(max_examples=100)
def test_a_search_in_noise_ends_and_the_number_of_jobs_does_not_show(chance, near_votes, jobs):
    def law(run):
        draw = hash((chance, run.value, seed(run))) % 1000 / 1000.0
        return None if draw > 0.9 else draw < 0.9 / (1.0 + math.exp(-12.0 * (run.value - 0.4)))

    plan = search(near_votes=near_votes, seeds=Seeds(key="seed", most=20), width=0.03)
    alone, together = made(plan, law)[0], made(plan, law, jobs)[0]
    found = plan.edge(alone.get)
    assert found == plan.edge(together.get) and not found.wanted
    assert found.note or abs(found.yes - found.no) <= 0.03


@pytest.mark.parametrize(("law", "said"), [
    (lambda run: True, "no edge: x = 0.0 has the outcome yes"),
    (lambda run: False, "no edge: x = 1.0 has the outcome no"),
    (lambda run: run.value < 0.5, "no edge: x = 0.0 has the outcome yes and x = 1.0 has the outcome no"),
    (lambda run: None, "x = 0.0: too many runs have failed, or have no outcome"),
    (lambda run: None if run.value == 0.5 else run.value > 0.3, "x = 0.5: too many runs have failed, or"),
])  # fmt: skip
def test_a_search_without_an_edge_says_why(law, said):
    plan = search()
    ended, order = made(plan, law)
    assert said in plan.edge(ended.get).note and len(order) <= 3


def test_an_edge_stays_one_where_the_value_beside_it_cannot_be_decided():
    plan = search(width=0.1)
    ended, order = made(plan, lambda run: None if run.value == 0.125 else run.value > 0.3)
    assert plan.edge(ended.get) == Edge(0.25, 0.3125) and order[-1].value == 0.125


def test_a_run_that_failed_is_replaced_by_another_seed():
    plan = search(seeds=Seeds(key="seed", most=9))
    ended, order = made(plan, lambda run: None if seed(run) == 1 else run.value > 0.3)
    assert (plan.edge(ended.get).no, plan.edge(ended.get).yes) == (0.25, 0.3125)
    assert {seed(run) for run in order} == {1, 2}


def test_an_outcome_that_goes_back_and_forth_is_told():
    plan = search(width=0.1)
    ended, order = made(plan, lambda run: run.value > 0.3 or 0.1 < run.value < 0.2)
    assert plan.edge(ended.get).monotone is False
    assert order[-1].value == 0.125  # amid the wider stretch beside the edge, from 0.25 to 0.3125
