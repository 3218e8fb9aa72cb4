"""The mutants: what is changed where, and which tests have to fail. Keep each one's tests to seconds."""

from typing import NamedTuple


class Mutant(NamedTuple):
    name: str
    """What the code does wrong now."""
    file: str
    old: str
    """Stands once in the file."""
    new: str
    tests: tuple[str, ...]
    """Files or single tests, as pytest takes them; all pass without the change."""


EPISODE, EXECUTION = "suite/trial/episode.py", "suite/trial/execution.py"
METRICS, OBSERVATION = "suite/trial/metrics.py", "suite/trial/observation.py"
AUDIT, MOTION = "suite/auditor/_kernels.py", "suite/auditor/motion/_kernels.py"
TESTS_OF_EPISODE = ("tests/suite/trial/test_episode.py",)
TESTS_OF_EXECUTION = ("tests/suite/trial/test_execution.py",)
TESTS_OF_METRICS = ("tests/suite/trial/test_metrics.py",)
TESTS_OF_OBSERVATION = ("tests/suite/trial/test_observation.py",)
TESTS_OF_CERTIFICATE = tuple(
    f"tests/suite/auditor/test_audit_certificate.py::test_{name}"
    for name in (
        "clearance_agrees_with_exact_arcs_and_never_overstates",
        "fast_small_things_are_not_leapt_over",
        "first_contact_is_a_contact_and_smallest_clearance_is_near_the_true_one",
        "after_a_graze_the_deepest_contact_is_still_found",
        "a_whole_second_is_looked_at_between_states_that_all_but_meet_there",
    )
)
AT_WORK = "tests/suite/trial/test_planners_at_work.py::test_"
CUBES, LAYERS = "tests/planners/search/test_cubes.py::test_", "tests/planners/search/test_layers.py::test_"

GROWTH, CONTACT = "tests/suite/store/test_growth.py::test_", "tests/suite/auditor/test_audit_contact.py::test_"

MUTANTS = (
    Mutant(
        "temporal is asked at every step, not at its path's end",
        "planners/paper/temporal.py",
        'commitment = "path"',
        'commitment = "step"',
        (AT_WORK + "the_papers_planners_are_asked_at_the_ends_of_their_paths",),
    ),
    Mutant(
        "rrt, prm and the other replanning ones are given no margin",
        "planners/base.py",
        "prediction_margin = 1.0",
        "prediction_margin = 0.0",
        (AT_WORK + "obstacles_are_grown_by_the_margin_that_the_planner_asks_for",),
    ),
    Mutant(
        "h waits instead of purging",
        "planners/paper/heuristics.py",
        "self._purged[cube] = True\n        return False",
        "return True",
        (AT_WORK + "on_a_blocked_path_h_finds_another_and_hs_waits",),
    ),
    Mutant(
        "h and hs enter a cube that holds an obstacle",
        "planners/paper/heuristics.py",
        "if kernels.contains_obstacle(",
        "if False and kernels.contains_obstacle(",
        (AT_WORK + "a_cube_that_holds_an_obstacle_is_blocked_though_a_thin_arm_could_share_it",),
    ),
    Mutant(
        "temporal's obstacles are a step late",
        "planners/paper/temporal.py",
        "scene_of(query.arm, self._space, q, now_s, query.world",
        "scene_of(query.arm, self._space, q, now_s - STEP_S, query.world",
        (AT_WORK + "temporals_states_are_free_of_the_obstacles_where_they_are_at_that_second",),
    ),
    Mutant(
        "the weight of a transition does not wrap theta",
        "planners/search/layers/_kernels.py",
        "turn = min(turn, 2.0 * math.pi - turn)",
        "turn = abs(turn)",
        (LAYERS + "the_weight_is_the_papers_with_theta_wrapped", LAYERS + "weights_by_hand"),
    ),
    Mutant(
        "a planner that replans keeps a path that no longer holds",
        EPISODE,
        "session.still_valid(*rest, observation)",
        "session.still_valid(*rest, observation) is not None",
        TESTS_OF_EPISODE,
    ),
    Mutant(
        "planning time is the last solve's",
        EPISODE,
        '"planning_time_s": float(times.sum())',
        '"planning_time_s": float(times[-1:].sum())',
        TESTS_OF_EPISODE,
    ),
    Mutant(
        "an arrival is called reached whatever the audit says",
        EPISODE,
        'outcome = "reached" if judged.per_step.success else "timeout" if late else "collided"',
        'outcome = "reached"',
        TESTS_OF_EPISODE,
    ),
    Mutant(
        "the arm arrives within twice the tolerance",
        EXECUTION,
        "distances <= self._tolerance_m",
        "distances <= 2.0 * self._tolerance_m",
        TESTS_OF_EXECUTION,
    ),
    Mutant(
        "the arm goes on after it has arrived",
        EXECUTION,
        "keep = arrived[0] + 1 if self.has_arrived else len(times)",
        "keep = len(times)",
        TESTS_OF_EXECUTION,
    ),
    Mutant(
        "the arm jumps to the next state at a whole second between two",
        EXECUTION,
        "np.interp(end_s, rest[0], column)",
        "column[min(last, len(column) - 1)]",
        TESTS_OF_EXECUTION,
    ),
    Mutant(
        "noise is ten times as small",
        OBSERVATION,
        "task.noise_mm / 1000.0",
        "task.noise_mm / 10000.0",
        TESTS_OF_OBSERVATION,
    ),
    Mutant(
        "an obstacle may never be seen",
        OBSERVATION,
        "lost[0] = False",
        "lost[0] |= False",
        TESTS_OF_OBSERVATION,
    ),
    Mutant(
        "the paper's smoothness does not wrap theta",
        METRICS,
        "turn = np.minimum(turn, 2.0 * np.pi - turn)",
        "turn = np.abs(turn)",
        TESTS_OF_METRICS,
    ),
    Mutant(
        "the tip's path is measured by eight chords",
        METRICS,
        "wanted = fine - coarse > _LAST_CHANGE * fine + _ROUNDING_M",
        "wanted = fine < 0.0",
        TESTS_OF_METRICS,
    ),
    Mutant(
        "mean planning time is over the trials that reached the goal",
        "suite/compare/tables.py",
        '"planning_time_mean_s": group[',
        '"planning_time_mean_s": reached[',
        ("tests/suite/compare/test_tables.py::test_failures_stay_in_success_and_planning_time",),
    ),
    Mutant(
        "the audit takes chords for arcs",
        AUDIT,
        "pad = length * bend / 8.0\n",
        "pad = 0.0\n",
        TESTS_OF_CERTIFICATE,
    ),
    Mutant(
        "the audit underrates how fast a section's base is carried",
        AUDIT,
        "carried += section_length * (turned + 0.5 * rate)",
        "carried += section_length * 0.5 * turned",
        ("tests/suite/auditor/test_audit_bounds.py::test_no_body_point_outruns_its_bound_however_hard_one_searches",),
    ),
    Mutant(
        "the audit looks no further once there is a contact",
        AUDIT,
        "return smallest - max(CONTACT_M, DEEPER_SHARE * abs(smallest))",
        "return -math.inf",
        TESTS_OF_CERTIFICATE,
    ),
    Mutant(
        "the audit looks at timed states but not at whole seconds",
        AUDIT,
        "stop = min(last, math.floor(start) + 1.0)",
        "stop = last",
        TESTS_OF_CERTIFICATE,
    ),
    Mutant(
        "limits have a slack of ten percent",
        MOTION,
        "LIMIT_SLACK = 1e-3",
        "LIMIT_SLACK = 1e-1",
        ("tests/suite/auditor/test_audit_bounds.py::test_the_slack_of_the_limits_is_the_one_that_docs_state",),
    ),
    Mutant(
        "an arc's distance is measured to its circle",
        "scenarios/kernels/clearance.py",
        "if h >= 0.0 and arc[16] * inward >= arc[17] * h:",
        "if h >= 0.0:",
        ("tests/scenarios/test_collision.py",),
    ),
    Mutant(
        "rows that an edited planner has left behind count as its own",
        "suite/store/growth.py",
        "        if code in codes:",
        "        if codes:",
        (f"{GROWTH}an_edited_planner_runs_again_alone_and_its_old_rows_stay",),
    ),
    Mutant(
        "noise is no condition of a row",
        "suite/trial/columns.py",
        '    "noise_mm",\n    "dropout",',
        '    "dropout",',
        (f"{GROWTH}another_condition_is_another_row",),
    ),
    Mutant(
        "tables show a trial's rows of any code",
        "suite/store/schema.py",
        "JOIN trials USING (key, house_code, planner_code)",
        "JOIN trials USING (key)",
        (f"{GROWTH}an_interrupted_run_of_stale_rows_goes_on",),
    ),
    Mutant(
        "rows of the first version pass for ones of the present code",
        "suite/store/run_folder.py",
        'house if is_house(house) and "schema_version" not in manifest else None',
        "house if is_house(house) else None",
        ("tests/suite/store/test_old_runs.py::test_a_manifest_that_is_new_says_nothing_of_old_rows",),
    ),
    Mutant(
        "reading a run makes the files in which SQLite shares a journal",
        "suite/store/schema.py",
        '"mode=ro&immutable=1"',
        '"mode=ro"',
        ("tests/suite/store/test_run_folder.py::test_reading_writes_nothing",),
    ),
    Mutant(
        "trials of two arms, or with and without noise, are summed up together",
        "suite/compare/tables.py",
        'WORLDS = ["family", "n_obstacles", *(column.name for column in WORLD)]',
        'WORLDS = ["family", "n_obstacles"]',
        ("tests/suite/compare/test_conditions.py",),
    ),
    Mutant(
        "a planner is handed the scenario that it is judged by",
        EPISODE,
        "theirs = scenario.model_copy(deep=True)",
        "theirs = scenario",
        ("tests/suite/trial/test_what_planners_are_handed.py",),
    ),
    Mutant(
        "what touched first is what was nearest last",
        AUDIT,
        "if work.touching[0] < 0:",
        "if work.nearest[0] >= 0:",
        (f"{CONTACT}what_is_said_to_touch_does_and_nothing_else_did_before",),
    ),
    Mutant(
        "an arm that sets out as it is touched was moving",
        "suite/auditor/judge.py",
        'times.searchsorted(found.swept_s, "left")',
        'times.searchsorted(found.swept_s, "right")',
        (f"{CONTACT}a_contact_at_a_timed_state_belongs_to_the_way_there",),
    ),
    Mutant(
        "the gate calls a loss within the margin a regression",
        "suite/compare/gate.py",
        "if finding.p_worse <= alpha and not finding.is_within_margin:",
        "if finding.p_worse <= alpha:",
        ("tests/suite/compare/test_gate.py::test_success_is_judged_in_pairs",),
    ),
    Mutant(
        "the gate's interval takes one run for the other",
        "suite/compare/statistics.py",
        "c = -only_base * difference * (1.0 - difference)",
        "c = -only_new * difference * (1.0 - difference)",
        ("tests/suite/compare/test_paired_statistics.py::test_tangos_interval_is_what_the_score_test_does_not_reject",),
    ),
    Mutant(
        "sensors see obstacles in the gaps of a recording",
        "suite/trial/observation.py",
        "lost[:, j] |= obstacle.unseen(self._times_s)",
        "lost[:, j] |= False",
        ("tests/suite/exchange/test_import_tracks.py::test_sensors_report_nothing_in_a_gap",),
    ),
    Mutant(
        "a merge takes rows that differ by the same code for equal",
        "suite/store/union.py",
        "elif before[1] != outcome:",
        "elif False:",
        ("tests/suite/test_merger.py::test_a_conflict_is_named_and_nothing_written",),
    ),
    Mutant(
        "a replay takes a collision that was foreseen for a wrong prediction",
        "suite/show/replay/story.py",
        "if left_m[worst] > 0:",
        "if left_m[worst] <= 0:",
        ("tests/suite/show/test_replay.py::test_the_story_tells_a_wrong_prediction_from_a_collision_foreseen",),
    ),
    Mutant(
        "a replay shows answers of a trial that went otherwise",
        "suite/show/replay/again.py",
        "_SAME_RAD = 1e-9",
        "_SAME_RAD = 1e-3",
        ("tests/suite/show/test_replay.py::test_a_trial_that_goes_otherwise_is_shown_without_its_planners_answers",),
    ),
    Mutant(
        "a name in a page can end its script",
        "suite/show/page.py",
        r'.replace("<", "\\u003c")',
        "",
        ("tests/suite/show/test_page.py::test_a_page_has_two_scripts_whatever_its_names_are",),
    ),
    Mutant(
        "a report knows no size",
        "suite/show/report/episodes.py",
        "sizes.index[sizes.cumsum() <= budget]",
        "sizes.index",
        ("tests/suite/show/test_report.py::test_a_report_keeps_within_its_size_and_shows_disagreements_first",),
    ),
    Mutant(
        "a profile takes a failure for a success",
        "suite/show/plots/profile.py",
        "cost.where(trials[success].fillna(False).astype(bool), np.inf)",
        "cost.where(trials[success].notna(), np.inf)",
        ("tests/suite/show/test_plot_kinds.py::test_a_profile_counts_failures_as_dearer_than_anything",),
    ),
)
