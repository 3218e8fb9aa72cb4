"""The world: arm, obstacles, scenario files, generator families and collision; knows no planner."""

from scenarios.arm import ContinuumArm
from scenarios.collision import are_states_valid, clearance, clearances, is_motion_valid, is_state_valid
from scenarios.errors import FileError, ScenarioError, UserError
from scenarios.families import FAMILIES, drawn, generate
from scenarios.families.drawing import start_is_free
from scenarios.files import load_scenarios, read_scenarios, save_scenarios
from scenarios.motion import Line, Orbit, Still, Track, Wander, Wave
from scenarios.obstacle import Obstacle
from scenarios.packed import PackedScenarios
from scenarios.scenario import STEP_S, Scenario
from scenarios.shaped_world import ShapedWorld, shaped_world
from scenarios.shapes import Box, Capsule, Cylinder, Mesh, Shape
from scenarios.spec import SpecError
from scenarios.world import SampledWorld, cover_world, make_world, sample_world

__all__ = [
    "FAMILIES",
    "STEP_S",
    "Box",
    "Capsule",
    "ContinuumArm",
    "Cylinder",
    "FileError",
    "Line",
    "Mesh",
    "Obstacle",
    "Orbit",
    "PackedScenarios",
    "SampledWorld",
    "Scenario",
    "ScenarioError",
    "Shape",
    "ShapedWorld",
    "SpecError",
    "Still",
    "Track",
    "UserError",
    "Wander",
    "Wave",
    "are_states_valid",
    "clearance",
    "clearances",
    "cover_world",
    "drawn",
    "generate",
    "is_motion_valid",
    "is_state_valid",
    "load_scenarios",
    "make_world",
    "read_scenarios",
    "sample_world",
    "save_scenarios",
    "shaped_world",
    "start_is_free",
]
