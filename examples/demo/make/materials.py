"""Procedural materials. Bumps tilt normals only, and only where one sees it (they double the cost); no material moves a surface."""

import bpy


def linear(color):
    """sRGB bytes to linear light."""

    def channel(value):
        value /= 255.0
        return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4

    return (*[channel(value) for value in color], 1.0)


def scaled(color, factor):
    return tuple(min(255.0, value * factor) for value in color)


class Graph:
    """A material's nodes, with less typing."""

    def __init__(self, name):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.shader = self.tree.nodes["Principled BSDF"]

    def node(self, kind, inputs=None, **settings):
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            self.plug(node.inputs[name], value)
        return node

    def plug(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def set(self, **inputs):
        for name, value in inputs.items():
            self.plug(self.shader.inputs[name.replace("_", " ")], value)

    def coordinates(self, scale, offset_per_object=False):
        texture = self.node("ShaderNodeTexCoord")
        mapping = self.node("ShaderNodeMapping", {"Vector": texture.outputs["Object"], "Scale": scale})
        if offset_per_object:
            info = self.node("ShaderNodeObjectInfo")
            spread = self.node("ShaderNodeMath", {0: info.outputs["Random"], 1: 40.0}, operation="MULTIPLY")
            vector = self.node("ShaderNodeCombineXYZ", {"X": spread.outputs[0], "Y": spread.outputs[0]})
            self.plug(mapping.inputs["Location"], vector.outputs[0])
        return mapping.outputs[0]

    def noise(self, vector, scale, detail=4.0, roughness=0.55, distortion=0.0):
        inputs = {"Vector": vector, "Scale": scale, "Detail": detail, "Roughness": roughness, "Distortion": distortion}
        return self.node("ShaderNodeTexNoise", inputs).outputs["Fac"]

    def ramp(self, factor, stops):
        node = self.node("ShaderNodeValToRGB", {"Fac": factor})
        while len(node.color_ramp.elements) < len(stops):
            node.color_ramp.elements.new(0.5)
        for element, (position, color) in zip(node.color_ramp.elements, stops):
            element.position, element.color = position, color
        return node.outputs["Color"]

    def between(self, factor, low, high):
        inputs = {"Value": factor, "From Min": 0.25, "From Max": 0.75, "To Min": low, "To Max": high}
        return self.node("ShaderNodeMapRange", inputs).outputs[0]

    def multiply(self, a, b, factor=1.0):
        return self.node("ShaderNodeMixRGB", {"Fac": factor, "Color1": a, "Color2": b}, blend_type="MULTIPLY").outputs[
            0
        ]

    def bump(self, height, strength, distance=0.001):
        inputs = {"Height": height, "Strength": strength, "Distance": distance}
        self.set(Normal=self.node("ShaderNodeBump", inputs).outputs[0])


def wood(name, color, grain_axis="x", fine=1.0, gloss=0.5, per_object=False):
    graph = Graph(name)
    along = {"x": (2.0, 24.0, 24.0), "z": (30.0, 30.0, 4.0)}[grain_axis]
    position = graph.coordinates(tuple(value * fine for value in along), per_object)
    rings = graph.noise(position, 1.6, 3.0, 0.6, 1.4)
    fibres = graph.noise(graph.coordinates(tuple(value * fine * 7.0 for value in along), per_object), 3.0, 2.0, 0.7)
    base = graph.ramp(
        rings, [(0.32, linear(scaled(color, 0.72))), (0.5, linear(color)), (0.66, linear(scaled(color, 1.14)))]
    )
    dark = graph.ramp(fibres, [(0.38, (0.62, 0.58, 0.55, 1.0)), (0.56, (1.0, 1.0, 1.0, 1.0))])
    graph.set(Base_Color=graph.multiply(base, dark, 0.8), Roughness=graph.between(fibres, gloss + 0.12, gloss - 0.08))
    return graph.material


def glaze(name, color):
    """Fired glaze: deep, glossy, with a little pooling and waviness."""
    graph = Graph(name)
    position = graph.coordinates((1.0, 1.0, 1.0))
    pools = graph.noise(position, 38.0, 6.0, 0.65, 0.6)
    specks = graph.noise(position, 900.0, 1.0)
    base = graph.ramp(
        pools, [(0.3, linear(scaled(color, 0.8))), (0.55, linear(color)), (0.8, linear(scaled(color, 1.22)))]
    )
    dots = graph.ramp(specks, [(0.27, (0.45, 0.36, 0.3, 1.0)), (0.31, (1.0, 1.0, 1.0, 1.0))])
    graph.set(
        Base_Color=graph.multiply(base, dots), Roughness=graph.between(pools, 0.12, 0.2), Specular=0.55, Clearcoat=0.5
    )
    graph.bump(graph.noise(position, 55.0, 2.0), 0.10)
    return graph.material


def clay(name, color):
    graph = Graph(name)
    grit = graph.noise(graph.coordinates((1.0, 1.0, 1.0)), 700.0, 4.0)
    graph.set(
        Base_Color=graph.multiply(
            linear(color), graph.ramp(grit, [(0.3, (0.7, 0.7, 0.7, 1.0)), (0.7, (1.0, 1.0, 1.0, 1.0))])
        )
    )
    graph.set(Roughness=0.9, Specular=0.2)
    graph.bump(grit, 0.3)
    return graph.material


def metal(name, color, roughness=0.3, scratch=(1.0, 1.0, 18.0)):
    """Brushed and fingered: roughness and tint vary, scratches run around the axis."""
    graph = Graph(name)
    smudges = graph.noise(graph.coordinates((1.0, 1.0, 1.0)), 60.0, 5.0, 0.6, 0.5)
    scratches = graph.noise(graph.coordinates(tuple(60.0 * value for value in scratch)), 12.0, 3.0)
    tint = graph.ramp(smudges, [(0.3, linear(scaled(color, 0.75))), (0.6, linear(color))])
    graph.set(Base_Color=tint, Metallic=1.0, Roughness=graph.between(smudges, roughness - 0.07, roughness + 0.12))
    graph.bump(scratches, 0.10)
    return graph.material


def paint(name, color, roughness=0.4):
    """Hand-painted wood: brush marks, worn a little."""
    graph = Graph(name)
    marks = graph.noise(graph.coordinates((8.0, 60.0, 60.0)), 6.0, 4.0)
    wear = graph.noise(graph.coordinates((1.0, 1.0, 1.0)), 130.0, 6.0, 0.75)
    tint = graph.ramp(marks, [(0.3, linear(scaled(color, 0.86))), (0.7, linear(scaled(color, 1.05)))])
    worn = graph.ramp(wear, [(0.30, (1.0, 1.0, 1.0, 1.0)), (0.325, (0.0, 0.0, 0.0, 1.0))])
    mixed = graph.node("ShaderNodeMixRGB", {"Fac": worn, "Color1": tint, "Color2": linear((196, 156, 108))}).outputs[0]
    graph.set(Base_Color=mixed, Roughness=graph.between(marks, roughness - 0.08, roughness + 0.12))
    return graph.material


def printed(name, image_path, roughness=0.38, metallic=0.0, interpolation="Linear"):
    graph = Graph(name)
    texture = graph.node("ShaderNodeTexImage", interpolation=interpolation)
    texture.image = bpy.data.images.load(str(image_path))
    smudges = graph.noise(graph.coordinates((1.0, 1.0, 1.0)), 45.0, 5.0)
    graph.set(
        Base_Color=texture.outputs["Color"],
        Roughness=graph.between(smudges, roughness - 0.08, roughness + 0.1),
        Metallic=metallic,
    )
    return graph.material


def fabric(name, color, stripe=None):
    """A plain weave by crossed waves; stripes along one direction."""
    graph = Graph(name)
    position = graph.coordinates((1.0, 1.0, 1.0))
    weave_x = graph.node(
        "ShaderNodeTexWave", {"Vector": position, "Scale": 160.0, "Distortion": 1.5, "Detail": 1.0}, bands_direction="X"
    )
    weave_y = graph.node(
        "ShaderNodeTexWave", {"Vector": position, "Scale": 160.0, "Distortion": 1.5, "Detail": 1.0}, bands_direction="Y"
    )
    threads = graph.node(
        "ShaderNodeMath", {0: weave_x.outputs["Fac"], 1: weave_y.outputs["Fac"]}, operation="ADD"
    ).outputs[0]
    shade = graph.ramp(threads, [(0.0, (0.7, 0.7, 0.7, 1.0)), (1.0, (1.0, 1.0, 1.0, 1.0))])
    base = linear(color)
    if stripe:
        bands = graph.node(
            "ShaderNodeTexWave", {"Vector": position, "Scale": 7.0, "Distortion": 0.0}, bands_direction="Y"
        )
        base = graph.ramp(bands.outputs["Fac"], [(0.80, linear(color)), (0.82, linear(stripe))])
    fuzz = graph.noise(position, 420.0, 3.0)
    shade = graph.multiply(shade, graph.ramp(fuzz, [(0.3, (0.82, 0.82, 0.82, 1.0)), (0.7, (1.0, 1.0, 1.0, 1.0))]))
    graph.set(Base_Color=graph.multiply(base, shade), Roughness=0.95, Specular=0.15, Sheen=0.4)
    graph.bump(threads, 0.5)
    return graph.material


def matte(name, color, roughness=0.75, mottle=0.14, scale=30.0, bump=0.15):
    graph = Graph(name)
    spots = graph.noise(graph.coordinates((1.0, 1.0, 1.0)), scale, 6.0, 0.6)
    tint = graph.ramp(spots, [(0.3, linear(scaled(color, 1.0 - mottle))), (0.7, linear(scaled(color, 1.0 + mottle)))])
    graph.set(
        Base_Color=tint, Roughness=graph.between(spots, roughness - 0.08, min(1.0, roughness + 0.1)), Specular=0.35
    )
    if bump > 0.2:
        graph.bump(spots, bump)
    return graph.material


def glow(name, color, strength):
    graph = Graph(name)
    graph.set(Base_Color=(0.0, 0.0, 0.0, 1.0), Emission=linear(color), Emission_Strength=strength)
    return graph.material


class Library:
    """The materials of the models, made once each."""

    def __init__(self, texture_path):
        self.texture_path = texture_path
        self.made = {}

    def get(self, kind, color):
        if kind not in self.made:
            self.made[kind] = self.make(kind, color)
        return self.made[kind]

    def make(self, kind, color):
        if kind == "tin":
            return printed(kind, self.texture_path, 0.34)
        if kind in ("walnut", "walnut_light"):
            return wood(kind, color, "z", 2.0, 0.36)
        if kind == "beech":
            return wood(kind, color, "x", 2.5, 0.45)
        if kind.startswith("glaze"):
            return glaze(kind, color)
        if kind == "clay":
            return clay(kind, color)
        if kind.startswith("paint"):
            return paint(kind, color)
        return metal(kind, color, {"steel": 0.22, "tin_metal": 0.3}.get(kind, 0.27))
