from hypothesis import given
from hypothesis import strategies as st

from suite.trial.lineup import Lineup


@given(st.sets(st.integers(0, 20)), st.data())
def test_a_lineup_is_what_a_list_would_be(chosen: set[int], data: st.DataObject) -> None:
    everything = [f"task {k}" for k in range(21)]  # nothing here looks into a task
    places = sorted(chosen)
    lineup = Lineup(lambda: iter(everything), range(21)).at(places)
    for _ in range(2):
        assert list(lineup) == [everything[k] for k in places]
    assert len(lineup) == len(places)
    again = data.draw(st.lists(st.sampled_from(range(len(places))), unique=True).map(sorted)) if places else []
    assert list(lineup.at(again)) == [everything[places[k]] for k in again]
