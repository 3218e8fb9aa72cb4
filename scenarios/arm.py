"""The arm: inextensible constant-curvature sections and the three ways to write a configuration.

Sources: notation and mappings from Arachchige and Godage, RoboSoft 2022, eqs. (1)-(3); the paper's 6-tuple is two
length changes per section (paper, section II-A).
"""

import math
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field

from scenarios.errors import ScenarioError
from scenarios.kernels import batch, kinematics
from scenarios.spec import parse_settings, parse_spec

FloatArray = npt.NDArray[np.float64]
_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, le=100.0)]


class ContinuumArm(BaseModel):
    """A continuum arm of n equal inextensible sections, its base at the origin, straight along +z when unbent.

    A configuration ``q`` is the chain of bending vectors (u1, v1, ..., un, vn), shape (2n,), [rad], with
    (u, v) = phi (cos theta, sin theta) per section and |(u, v)| <= ``max_bend_rad``.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    n_sections: int = Field(default=3, ge=1, le=12, description="number of bending sections")
    section_length_m: _Positive = Field(default=0.15, description="length of each section's backbone")
    radius_m: _Positive = Field(default=0.018, description="radius of the body around the backbone")
    max_bend_rad: float = Field(default=math.pi, gt=0, le=math.pi, description="largest bend of a section")
    actuator_offset_m: _Positive = Field(default=0.0125, description="distance of the actuators from the backbone")
    max_bend_rate_rad_s: _Positive = Field(default=0.5, description="largest rate of a section's bending vector")
    max_tip_speed_m_s: _Positive = Field(default=0.01 * math.sqrt(3.0), description="one cube diagonal per step")

    @property
    def dof(self) -> int:
        """Length of a configuration: two per section."""
        return 2 * self.n_sections

    @property
    def length_m(self) -> float:
        """Length of the whole backbone."""
        return self.n_sections * self.section_length_m

    def check_configurations(self, configurations: npt.ArrayLike) -> FloatArray:
        """Return configurations as a contiguous array (N, dof), [rad].

        Raises:
            ScenarioError: Another shape, a number that is not finite, or a bend past ``max_bend_rad``.
        """
        q = np.atleast_2d(np.ascontiguousarray(configurations, dtype=np.float64))
        if q.ndim != 2 or q.shape[1] != self.dof:
            raise ScenarioError(f"configuration: found shape {np.shape(configurations)}, allowed ({self.dof},)")
        if not self.within_bends(q).all():  # nor is a bend that is not a number
            if not np.isfinite(q).all():
                raise ScenarioError("configuration: found a number that is not finite, allowed finite numbers [rad]")
            bend = np.hypot(q[:, 0::2], q[:, 1::2]).max()
            raise ScenarioError(f"configuration: found a bend of {bend:.4f} rad, allowed up to {self.max_bend_rad:.4f}")
        return q

    def within_bends(self, configurations: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether every section's bend is allowed: (N, dof) [rad] -> (N,)."""
        rows = np.ascontiguousarray(configurations, dtype=np.float64).reshape(-1, self.dof)
        within: npt.NDArray[np.bool_] = batch.within_bends(rows, self.max_bend_rad + 1e-9)
        return within.reshape(np.shape(configurations)[:-1])

    def tip(self, q: npt.ArrayLike) -> FloatArray:
        """Tip position (3,) [m] of one configuration (dof,) [rad]."""
        return np.asarray(self.tips(q)[0])

    def tips(self, configurations: npt.ArrayLike) -> FloatArray:
        """Tip positions (N, 3) [m] of configurations (N, dof) [rad]."""
        tips: FloatArray = kinematics.tips(self.check_configurations(configurations), self.section_length_m)
        return tips

    def backbone_points(self, q: npt.ArrayLike, points_per_section: int = 20) -> FloatArray:
        """Points (n * points_per_section + 1, 3) [m] at equal spacing along the backbone, the base first."""
        checked = self.check_configurations(q)[0]
        points: FloatArray = kinematics.backbone(checked, self.section_length_m, points_per_section)
        return points

    def jacobian(self, q: npt.ArrayLike, arc_length_m: float | None = None) -> FloatArray:
        """Derivative (3, dof) [m/rad] of the backbone point at ``arc_length_m`` (the tip when None)."""
        at = self.length_m if arc_length_m is None else arc_length_m
        if not 0.0 <= at <= self.length_m:
            raise ScenarioError(f"arc_length_m: found {at}, allowed [0, {self.length_m}]")
        out = np.empty((3, self.dof))
        kinematics.position_jacobian(self.check_configurations(q)[0], self.section_length_m, at, out)
        return out

    @classmethod
    def from_text(cls, settings: str) -> "ContinuumArm":
        """The default arm but for ``settings``, such as ``radius_m=0.015,n_sections=2``.

        Raises:
            SpecError: An unknown setting or a value out of range.
        """
        return parse_settings("arm", cls, parse_spec(f"arm[{settings}]")[1])

    def bending_from_arcs(self, arcs: npt.ArrayLike) -> FloatArray:
        """Configuration (dof,) [rad] from rows (theta, phi) (n, 2) [rad]."""
        theta, phi = np.asarray(arcs, dtype=np.float64).reshape(self.n_sections, 2).T
        return np.stack([phi * np.cos(theta), phi * np.sin(theta)], axis=1).reshape(-1)

    def arcs_from_bending(self, q: npt.ArrayLike) -> FloatArray:
        """Rows (theta, phi) (n, 2) [rad] of a configuration; theta in (-pi, pi], 0 for a straight section."""
        u, v = np.asarray(q, dtype=np.float64).reshape(self.n_sections, 2).T
        return np.stack([np.arctan2(v, u), np.hypot(u, v)], axis=1)

    def lengths_from_bending(self, q: npt.ArrayLike) -> FloatArray:
        """Length changes (n, 3) [m] of the three actuators of each section; each row sums to zero.

        l_i = -r phi cos(2 pi (i - 1) / 3 - theta): RoboSoft 2022, eq. (1).
        """
        bending = np.asarray(q, dtype=np.float64).reshape(self.n_sections, 2)
        angles = 2.0 * np.pi / 3.0 * np.arange(3)
        return np.asarray(-self.actuator_offset_m * bending @ np.stack([np.cos(angles), np.sin(angles)]))

    def bending_from_lengths(self, lengths_m: npt.ArrayLike) -> FloatArray:
        """Configuration (dof,) [rad] from length changes, shape (n, 3), or (n, 2) for the second and third alone [m].

        Raises:
            ScenarioError: Three length changes of a section do not sum to zero (the backbone cannot stretch).
        """
        lengths = np.asarray(lengths_m, dtype=np.float64).reshape(self.n_sections, -1)
        if lengths.shape[1] == 3 and np.abs(lengths.sum(axis=1)).max() > 1e-9:
            raise ScenarioError("lengths_m: found length changes that do not sum to 0, allowed l1 + l2 + l3 = 0")
        l2, l3 = lengths[:, -2], lengths[:, -1]
        u = (l2 + l3) / self.actuator_offset_m
        v = (l3 - l2) / (math.sqrt(3.0) * self.actuator_offset_m)
        return np.stack([u, v], axis=1).reshape(-1)
