"""Building blocks for meshes: lathe, loft, sweep, extrusion. Lengths are millimetres; the axis is z."""

import math

import bmesh


def ring(bm, points):
    return [bm.verts.new(point) for point in points]


def bridge(bm, lower, upper, region):
    """Quads between two closed rings of equal length (or a ring and a single vertex)."""
    count = max(len(lower), len(upper))
    for i in range(count):
        j = (i + 1) % count
        corners = [lower[i % len(lower)], lower[j % len(lower)], upper[j % len(upper)], upper[i % len(upper)]]
        unique = list(dict.fromkeys(corners))
        if len(unique) > 2:
            bm.faces.new(unique).material_index = region


def lathe(bm, profile, segments, matrix=None):
    """Turns `profile`, a list of (radius, z, region), about z. A region belongs to the piece that ends at its point.

    The profile runs from bottom to top along the outside, so that faces look outwards.
    """
    previous = None
    created = []
    for radius, z, region in profile:
        if radius == 0.0:
            current = ring(bm, [(0.0, 0.0, z)])
        else:
            angles = [2.0 * math.pi * i / segments for i in range(segments)]
            current = ring(bm, [(radius * math.cos(a), radius * math.sin(a), z) for a in angles])
        if previous is not None:
            bridge(bm, previous, current, region)
        created += current
        previous = current
    if matrix is not None:
        bmesh.ops.transform(bm, matrix=matrix, verts=created)
    return created


def loft(bm, rings, regions):
    """Joins rings of points, one above the other."""
    previous = None
    for points, region in zip(rings, regions):
        current = ring(bm, points)
        if previous is not None:
            bridge(bm, previous, current, region)
        previous = current


def sweep(bm, path, sides, radii, region):
    """A tube of elliptic section along a planar path of (x, z) points; `radii` gives (in the plane, across) for each."""
    rings = []
    for i, (x, z) in enumerate(path):
        before, after = path[max(i - 1, 0)], path[min(i + 1, len(path) - 1)]
        tangent = (after[0] - before[0], after[1] - before[1])
        length = math.hypot(*tangent)
        normal = (-tangent[1] / length, tangent[0] / length)
        in_plane, across = radii[i]
        points = []
        for k in range(sides):
            angle = 2.0 * math.pi * k / sides
            offset = in_plane * math.cos(angle)
            points.append((x + normal[0] * offset, across * math.sin(angle), z + normal[1] * offset))
        rings.append(ring(bm, points))
    for lower, upper in zip(rings, rings[1:]):
        bridge(bm, lower, upper, region)
    bm.faces.new(rings[0][::-1]).material_index = region
    bm.faces.new(rings[-1]).material_index = region


def extrude(bm, outlines, width, region, bevel, bevel_segments):
    """A plate in the xz plane with holes (`outlines`: the outer one first), `width` thick along y, its rims rounded."""
    plate = bmesh.new()
    for outline in outlines:
        corners = [plate.verts.new((x, -width / 2.0, z)) for x, z in outline]
        for a, b in zip(corners, corners[1:] + corners[:1]):
            plate.edges.new((a, b))
    bmesh.ops.triangle_fill(plate, edges=plate.edges[:], use_beauty=True)
    grown = bmesh.ops.extrude_face_region(plate, geom=plate.faces[:], use_keep_orig=True)["geom"]
    bmesh.ops.translate(plate, vec=(0.0, width, 0.0), verts=[g for g in grown if isinstance(g, bmesh.types.BMVert)])
    bmesh.ops.recalc_face_normals(plate, faces=plate.faces[:])
    rims = [edge for edge in plate.edges if len(edge.link_faces) == 2 and edge.calc_face_angle() > 1.2]
    bmesh.ops.bevel(plate, geom=rims, offset=bevel, segments=bevel_segments, profile=0.5, affect="EDGES")
    copy_into(bm, plate, region)
    plate.free()


def copy_into(bm, part, region):
    copies = {vertex: bm.verts.new(vertex.co) for vertex in part.verts}
    for face in part.faces:
        bm.faces.new([copies[vertex] for vertex in face.verts]).material_index = region


def rounded_rectangle(width, depth, radius, spacing):
    """Points of equal spacing around a rounded rectangle, with the arc length of each, from the middle of the front.

    Counter-clockwise seen from above; the front looks along -y.
    """
    straight_x, straight_y, quarter = width - 2 * radius, depth - 2 * radius, math.pi * radius / 2
    pieces = [straight_x / 2, quarter, straight_y, quarter, straight_x, quarter, straight_y, quarter, straight_x / 2]
    perimeter = sum(pieces)
    count = 4 * round(perimeter / spacing / 4)

    def at(s):
        position, heading = (0.0, -depth / 2), 0.0
        for number, length in enumerate(pieces):
            part = min(s, length)
            if number % 2 == 0:
                position = (position[0] + part * math.cos(heading), position[1] + part * math.sin(heading))
            else:
                turn = part / radius
                centre = (position[0] - radius * math.sin(heading), position[1] + radius * math.cos(heading))
                heading += turn
                position = (centre[0] + radius * math.sin(heading), centre[1] - radius * math.cos(heading))
            s -= part
            if s <= 0.0:
                break
        return position

    arcs = [perimeter * i / count for i in range(count)]
    return [at(s) for s in arcs], arcs, perimeter


def smooth_closed(points, steps):
    """A closed Catmull-Rom curve through `points`."""
    curve = []
    count = len(points)
    for i in range(count):
        p = [points[(i + k - 1) % count] for k in range(4)]
        for s in range(steps):
            t = s / steps
            curve.append(tuple(catmull_rom(*[q[axis] for q in p], t) for axis in (0, 1)))
    return curve


def smooth_open(points, steps):
    """A Catmull-Rom curve through `points`, ends included."""
    padded = [points[0], *points, points[-1]]
    curve = []
    for i in range(len(points) - 1):
        for s in range(steps):
            t = s / steps
            curve.append(tuple(catmull_rom(*[q[axis] for q in padded[i : i + 4]], t) for axis in range(len(points[0]))))
    return [*curve, tuple(points[-1])]


def catmull_rom(a, b, c, d, t):
    return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t**3)
