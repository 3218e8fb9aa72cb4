"""Random convex shapes, and obstacles that carry them."""

from scenarios import Box, Capsule, Cylinder, Line, Mesh, Obstacle

KINDS = ("box", "capsule", "cylinder", "mesh")


def random_shape(rng, kind):
    rotation = tuple(rng.normal(size=3))
    if kind == "box":
        return Box(size_m=tuple(rng.uniform(0.005, 0.15, 3)), rotation_rad=rotation)
    if kind == "capsule":
        return Capsule(radius_m=rng.uniform(0.005, 0.04), length_m=rng.uniform(0.005, 0.15), rotation_rad=rotation)
    if kind == "cylinder":
        return Cylinder(radius_m=rng.uniform(0.005, 0.06), length_m=rng.uniform(0.005, 0.15), rotation_rad=rotation)
    vertices = 0.04 * rng.normal(size=(rng.integers(4, 40), 3))
    return Mesh(vertices_m=tuple(map(tuple, vertices.tolist())), rotation_rad=rotation)


def moving(shape, point, velocity=(0.0, 0.0, 0.0)):
    return Obstacle(shape=shape, motion=Line(point_m=tuple(point), velocity_m_s=tuple(velocity)))
