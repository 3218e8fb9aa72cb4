import hashlib
import json

from scenarios import PackedScenarios, Scenario, generate
from scenarios.packed import CHUNK


def test_what_is_packed_comes_out_as_it_was_time_and_again() -> None:
    scenarios = [s for family in ("orbit", "crossing", "wander") for s in generate(family, 2, CHUNK // 2, seed=1000)]
    packed = PackedScenarios(iter(scenarios))
    assert len(packed) == len(scenarios) > CHUNK
    assert list(packed) == list(packed) == scenarios
    assert [Scenario(**json.loads(line)) for line in packed.lines()] == scenarios


def test_what_is_known_of_all_is_theirs() -> None:
    scenarios = generate("orbit", 1, 3, seed=1000)
    other = scenarios[0].model_copy(update={"arm": scenarios[0].arm.model_copy(update={"radius_m": 0.01})})
    packed = PackedScenarios([*scenarios, other])
    assert packed.arms == (scenarios[0].arm, other.arm)
    hashes = "".join(s.content_hash for s in (*scenarios, other))
    assert packed.digest == hashlib.sha256(hashes.encode()).hexdigest()[:16]
    assert PackedScenarios([other, *scenarios]).digest != packed.digest


def test_a_packed_scenario_takes_a_few_hundred_bytes() -> None:
    packed = PackedScenarios(generate("orbit", 1, CHUNK, seed=1000))
    assert sum(map(len, packed._chunks)) < 300 * CHUNK
