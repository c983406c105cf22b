"""Ratios of times: what else goes on in a machine must not decide them."""

from fuzzyq_bullet.experiments.timing import interleaved, least_ratio, median_ratio


def test_the_least_times_tell_the_ratio_however_much_is_added_to_most_of_the_others():
    quick, slow = [[2.0, 2.9, 9.0], [1.5, 1.0, 7.0]], [[8.0, 4.0, 4.5], [6.0, 11.0, 2.0]]
    assert least_ratio(quick, slow) == 3.0 / 6.0


def test_the_median_is_that_of_the_pairs_of_a_round():
    assert median_ratio([1.0, 9.0, 3.0], [2.0, 1.0, 4.0]) == 0.75


def test_works_take_turns_and_each_time_is_its_own():
    done, now = [], iter(range(100))
    works = [lambda: done.append("a"), lambda: done.append("b")]
    times = interleaved(works, 3, clock=lambda: next(now) ** 2)
    assert "".join(done) == "ababab"
    assert times == [[1, 9, 17], [5, 13, 21]]
