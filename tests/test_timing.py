"""Ratios of times: what else goes on in a machine must not decide them."""

from fuzzyq_bullet.experiments.timing import interleaved, median_ratio


def test_the_median_is_that_of_the_pairs_of_a_round():
    assert median_ratio([1.0, 9.0, 3.0], [2.0, 1.0, 4.0]) == 0.75


def test_works_take_turns_and_each_time_is_its_own():
    done, now = [], iter(range(100))
    works = [lambda: done.append("a"), lambda: done.append("b")]
    times = interleaved(works, 3, clock=lambda: next(now) ** 2)
    assert "".join(done) == "ababab"
    assert times == [[1, 9, 17], [5, 13, 21]]
