"""A writer of archives that shares nothing with the package: bytes put together with `struct` and text.

Two steps; level 0 of 4 x 2 x 1 cells in two patches with an extra cell in x, level 1 of one patch that divides
2 x 2 x 1 of them by two. What each patch stores is written down by hand after the description of the format.
"""

import struct
import zlib

CODES = {
    "double": ("d", 1),
    "float": ("f", 1),
    "int": ("i", 1),
    "short int": ("h", 1),
    "long64": ("q", 1),
    "bool": ("B", 1),
    "unsigned char": ("B", 1),
    "Point": ("d", 3),
    "Vector": ("d", 3),
    "IntVector": ("i", 3),
    "Matrix3": ("d", 9),
    "Stencil7": ("d", 7),
    "Stencil4": ("d", 4),
    "Short27": ("h", 27),
    "Int130": ("i", 400),
}
"""Code of `struct` and numbers of an element."""

PATCHES = {0: [(0, (0, 0, 0), (2, 2, 1)), (1, (2, 0, 0), (4, 2, 1))], 1: [(2, (2, 0, 0), (6, 4, 2))]}
"""Number, first and last cell (exclusive) of the patches of each level."""

EXTENTS = {
    "CCVariable": {0: ((-1, 0, 0), (2, 2, 1)), 1: ((2, 0, 0), (5, 2, 1)), 2: ((1, 0, 0), (7, 4, 2))},
    "NCVariable": {0: ((-1, 0, 0), (2, 3, 2)), 1: ((2, 0, 0), (6, 3, 2)), 2: ((1, 0, 0), (8, 5, 3))},
    "SFCXVariable": {0: ((-1, 0, 0), (2, 2, 1)), 1: ((2, 0, 0), (6, 2, 1)), 2: ((1, 0, 0), (8, 4, 2))},
    "SFCYVariable": {0: ((-1, 0, 0), (2, 3, 1)), 1: ((2, 0, 0), (5, 3, 1)), 2: ((1, 0, 0), (7, 5, 2))},
    "SFCZVariable": {0: ((-1, 0, 0), (2, 2, 2)), 1: ((2, 0, 0), (5, 2, 2)), 2: ((1, 0, 0), (7, 4, 3))},
}
"""Indices that each patch stores, by where the values sit."""

PARTICLES = {
    1: {0: [(7, 0.25), (5, 1.75)], 1: [(11, 3.5)], 2: [(2, 1.25), (3, 2.5), (9, 2.75)]},
    2: {0: [(5, 1.5)], 1: [(11, 3.75), (7, 2.25)], 2: [(3, 2.25), (2, 1.5)]},
}
"""By step and patch, identity and x of the particles of material 0 in stored order; 9 is gone in step 2."""

TIMES = {1: 0.5, 2: 0.75}


def number(seed, component, code):
    """A number for the component of an element, within the range of its type."""
    value = seed * 31 + component * 7
    if code in "df":
        return value / 8 - 5
    return value % 2 if code == "B" else value % 30000 - 15000


def element_values(seed, element):
    code, count = CODES[element]
    return [number(seed, component, code) for component in range(count)]


def grid_seed(level, step, material, i, j, k):
    return (((level * 2 + step) * 3 + material) * 20 + i + 3) * 400 + j * 20 + k


def particle_seed(step, identity):
    return step * 100 + identity


class Writer:
    """Writes an archive of some byte order, address width, compression and number of ranks."""

    def __init__(self, folder, order="<", bits=64, compression="", ranks=1):
        self.folder, self.order, self.bits = folder, order, bits
        self.compression, self.ranks = compression, ranks

    def rank(self, patch):
        return patch % self.ranks

    def variables(self):
        yield "p.x", "ParticleVariable", "Point"
        yield "p.particleID", "ParticleVariable", "long64"
        for element in CODES:
            yield f"p.{element.replace(' ', '_')}", "ParticleVariable", element
        for container in EXTENTS:
            for element in CODES:
                yield f"{container[:4]}.{element.replace(' ', '_')}", container, element
        yield "count", "PerPatch", "int"
        yield "share", "PerPatch", "double"

    def write(self):
        for step, time in TIMES.items():
            folder = self.folder / f"t{step:05d}"
            for level in PATCHES:
                (folder / f"l{level}").mkdir(parents=True)
                for rank in range(self.ranks):
                    self.write_rank(folder / f"l{level}", step, level, rank)
            (folder / "timestep.xml").write_text(self.timestep(step, time))
        self.write_index()
        return self.folder

    def write_rank(self, folder, step, level, rank):
        patches = [patch for patch, _low, _high in PATCHES[level] if self.rank(patch) == rank]
        if not patches:
            return
        data, table = bytearray(), ["<?xml version='1.0'?>", "<Uintah_Output>"]
        for name, container, element in self.variables():
            for patch in patches:
                for material in (0,) if container == "ParticleVariable" else (0, 1):
                    raw, count = self.block(step, level, patch, material, name, container, element)
                    if self.compression:
                        size = struct.pack(self.order + ("Q" if self.bits == 64 else "I"), len(raw))
                        raw = size + zlib.compress(raw)
                    data += bytes(-len(data) % 1024)
                    table.append(
                        f'<Variable type="{container}&lt;{element}&gt;"><variable>{name}</variable>'
                        f"<index>{material}</index><patch>{patch}</patch><start>{len(data)}</start>"
                        + (f"<numParticles>{count}</numParticles>" if count is not None else "")
                        + ("<compression>gzip</compression>" if self.compression else "")
                        + f"<end>{len(data) + len(raw)}</end><filename>p{rank:05d}.data</filename></Variable>"
                    )
                    data += raw
        (folder / f"p{rank:05d}.data").write_bytes(data)
        (folder / f"p{rank:05d}.xml").write_text("\n".join([*table, "</Uintah_Output>"]) + "\n")

    def block(self, step, level, patch, material, name, container, element):
        code, _count = CODES[element]
        if container == "ParticleVariable":
            there = PARTICLES[step][patch]
            if name == "p.x":
                values = [number for _identity, x in there for number in (x, 0.5, 0.25)]
            elif name == "p.particleID":
                values = [identity for identity, _x in there]
            else:
                values = [
                    v
                    for identity, _x in there
                    for v in element_values(particle_seed(step, identity), element)
                ]
            return struct.pack(f"{self.order}{len(values)}{code}", *values), len(there)
        if container == "PerPatch":
            return struct.pack(self.order + code, patch * 10 + material + step), None
        low, high = EXTENTS[container][patch]
        values = [
            value
            for k in range(low[2], high[2])
            for j in range(low[1], high[1])
            for i in range(low[0], high[0])
            for value in element_values(grid_seed(level, step, material, i, j, k), element)
        ]
        return struct.pack(f"{self.order}{len(values)}{code}", *values), None

    def meta(self):
        endianness = {"<": "little_endian", ">": "big_endian"}[self.order]
        return f"<Meta>\n<endianness>{endianness}</endianness>\n<nBits>{self.bits}</nBits>\n</Meta>"

    def timestep(self, step, time):
        lines = ["<?xml version='1.0'?>", "<Uintah_timestep>", self.meta(), "<Time>"]
        lines += [f"<timestepNumber>{step}</timestepNumber>", f"<currentTime>{time}</currentTime>", "</Time>"]
        lines += ["<Grid>", "<numLevels>2</numLevels>"]
        for level, patches in PATCHES.items():
            width = 1.0 / 2**level
            lines += [
                "<Level>",
                f"<numPatches>{len(patches)}</numPatches>",
                "<extraCells>[1, 0, 0]</extraCells>",
            ]
            lines += ["<anchor>[0, 0, 0]</anchor>", f"<id>{level}</id>"]
            lines += [f"<cellspacing>[{width}, {width}, {width}]</cellspacing>"]
            for patch, low, high in patches:
                stored = EXTENTS["CCVariable"][patch]
                lines += ["<Patch>", f"<id>{patch}</id>", f"<proc>{self.rank(patch)}</proc>"]
                lines += [
                    f"<lowIndex>{list(stored[0])}</lowIndex>",
                    f"<highIndex>{list(stored[1])}</highIndex>",
                ]
                lines += [f"<interiorLowIndex>{list(low)}</interiorLowIndex>"]
                lines += [f"<interiorHighIndex>{list(high)}</interiorHighIndex>", "</Patch>"]
            lines.append("</Level>")
        return "\n".join([*lines, "</Grid>", "<Data>", "</Data>", "</Uintah_timestep>"]) + "\n"

    def write_index(self):
        lines = ["<?xml version='1.0'?>", "<Uintah_DataArchive>", self.meta(), "<variables>"]
        lines += [
            f'<variable type="{container}&lt;{element}&gt;" name="{name}"/>'
            for name, container, element in self.variables()
        ]
        lines += ["</variables>", "<timesteps>"]
        lines += [
            f'<timestep href="t{step:05d}/timestep.xml" time="{time}">{step}</timestep>'
            for step, time in TIMES.items()
        ]
        (self.folder / "index.xml").write_text(
            "\n".join([*lines, "</timesteps>", "</Uintah_DataArchive>"]) + "\n"
        )
