"""Random inputs, and random damage as by typing errors and broken disks. All randomness comes from the given random.Random."""

import json

NASTY = ['<img src=x onerror=alert(1)>', '</script><script>alert(1)</script>', "'\"`$(touch canary)`touch canary`", '";system("touch canary");"',
         "'; touch canary; '", '\u202ereversed\u202c', '\u2028\u2029', '{/Symbol a}_{b}^{c} @x', '%s%n%d', '=1+1', 'a' * 10_000, '\x1b[31mred\x07',
         '../../canary', 'ß漢字🙂', '&amp;&lt;', '\\n\\', '-o', '--help', '#', ' ']
TOKENS = [b'-', b'nan', b'inf', b'"', b'[', b']', b'[[', b'=', b'0', b'1e999', b',', b'\n', b'.', b'#', b'true', b'\xff', b'{', b'}', b"'", b'1e-320',
          b'\0', b'null', b'-1', b'1e308', b'99999999999999999999', b'2147483648', b'\\u0000', b'\xe2\x80\xae', b'../', b'9007199254740993']


def toml(value):
    if isinstance(value, bool):
        return 'true' if value else 'false'
    if isinstance(value, dict):
        return '{ ' + ', '.join(f'{key} = {toml(item)}' for key, item in value.items()) + ' }'
    if isinstance(value, (list, tuple)):
        return '[' + ', '.join(map(toml, value)) + ']'
    if isinstance(value, str):  # JSON's escapes are valid in TOML, except for surrogate pairs
        return json.dumps(value, ensure_ascii=False).replace('\x7f', '\\u007f')
    return repr(value)


def mutate(random, data: bytes, most=3) -> bytes:
    text = bytearray(data)
    for _ in range(random.randint(1, most)):
        at = random.randrange(len(text) + 1)
        choice = random.randrange(8)
        if choice == 0:
            del text[at:at + random.randint(1, 8)]
        elif choice == 1:
            text[at:at] = random.choice(TOKENS)
        elif choice == 2 and at < len(text):
            text[at] = random.randrange(256)
        elif choice == 3 and random.random() < 0.3:
            del text[at:]
        elif choice == 4:
            copied = random.randrange(len(text) + 1)
            text[at:at] = text[copied:copied + random.randint(1, 40)]
        elif choice == 5:
            lines = text.split(b'\n')
            lines.insert(random.randrange(len(lines)), random.choice(lines))
            text = bytearray(b'\n'.join(lines))
        elif choice == 6:
            lines = text.split(b'\n')
            del lines[random.randrange(len(lines))]
            text = bytearray(b'\n'.join(lines))
        else:
            digits = [i for i, c in enumerate(text) if chr(c).isdigit()]
            if digits:
                at = random.choice(digits)
                text[at:at + 1] = random.choice([b'0', b'9', b'-1', b'1e9', b'1e-9', b'7', b'5', b'"1/64"'])
    return bytes(text)


class Maker:
    """Generator of inputs, most of them valid."""

    def __init__(self, random):
        self.random = random

    def maybe(self, chance=0.5):
        return self.random.random() < chance

    def log(self, low, high):
        """A number between these limits, uniform in its logarithm."""
        return float(f'{low * (high / low) ** self.random.random():.4g}')

    def vector(self, size=1.0):
        return [float(f'{self.random.gauss(0, size):.4g}') for _ in range(3)]

    def text(self):
        return self.random.choice(NASTY) if self.maybe(0.3) else 'A cloth'

    def motion(self):
        moved = {}
        if self.maybe(0.3):
            moved['velocity'] = self.vector(self.log(0.01, 100))
        if self.maybe(0.2):
            moved['spin'] = self.vector(self.log(0.01, 100))
        if self.maybe(0.2):
            times = sorted({round(self.random.random(), 3) for _ in range(3)})
            moved['path'] = [{'t': t, 'displacement': self.vector(self.log(0.01, 10))} for t in times]
        return moved

    def collider(self, body=None):
        """body: an OBJ file that one of the colliders may use."""
        kind = self.random.choice(['plane', 'ball', 'box', 'capsule'] + (['mesh'] if body else []))
        one = {'type': kind, 'friction': self.random.choice([0, 0.5, 1000]), **self.motion()}
        if kind == 'plane':
            one.update(normal=self.vector(), offset=-self.log(0.01, 100))
        elif kind == 'capsule':
            one.update({end: self.vector(self.log(0.1, 10)) for end in ('from', 'to')})
        else:
            one['center'] = self.vector(self.log(0.1, 10))
        if kind in ('ball', 'capsule'):
            one['radius'] = self.log(1e-3, 10)
        if kind == 'mesh':
            one.update(file=body, scale=self.log(0.1, 10), sides=self.random.choice(['out', 'out', 'both']))
        if kind == 'box':
            one.update(half_extents=[self.log(1e-3, 5) for _ in range(3)], rotation={'axis': self.vector(), 'angle': self.random.uniform(-180, 180)})
        return one

    def scene(self, mesh=None, body=None):
        r = self.random
        nu, nv = r.randint(1, 9), r.randint(2, 9)
        cloth = {'mesh': mesh} if mesh else {'grid': [nu, nv], 'size': [self.log(1e-3, 100), self.log(1e-3, 100)]}
        cloth['mass'] = self.log(1e-6, 1e4)
        pins = ['top', 'bottom', 'left', 'top-left', 'bottom-right', 0, 1]
        if not mesh and self.maybe(0.8):
            cloth['pins'] = [r.choice(pins) for _ in range(r.randint(1, 3))]
        if self.maybe(0.2):
            cloth['stretch'] = self.log(1e-3, 1e3)
        if self.maybe(0.2):
            cloth['velocity'] = self.vector(self.log(0.01, 1e4))
        if self.maybe(0.2) and not mesh:
            cloth['weights'] = [{'vertices': ['bottom'], 'factor': self.log(1e-6, 1e6)}]
        tables = {'cloth': cloth, 'time': {'dt': r.choice(['1/64', '1/1000', 0.5, self.log(1e-5, 10)])}}
        tables['time']['duration'] = tables['time']['dt'] if isinstance(tables['time']['dt'], str) else r.randint(1, 60) * tables['time']['dt']
        if self.maybe(0.7):
            tables['time']['duration'] = 0.3
        if self.maybe(0.3):
            tables['links'] = {'shear': self.maybe(), 'bend': self.maybe()}
        if self.maybe(0.3):
            tables['forces'] = {'gravity': self.vector(self.log(0.1, 1e4)), 'damping': self.log(1e-3, 1e3)}
        if self.maybe(0.2):
            tables['wind'] = {'velocity': self.vector(self.log(0.1, 1e4)), 'strength': self.log(1e-3, 100), 'law': r.choice(['relative', 'literal'])}
        if self.maybe(0.2):
            tables['bending'] = {'stiffness': r.choice([self.log(1e-9, 1), {'warp': self.log(1e-9, 1), 'weft': self.log(1e-9, 1)}])}
        if self.maybe(0.2) and 'links' not in tables:
            tables['membrane'] = {'stiffness': self.log(1e-3, 1e5), **r.choice([{'law': 'arap'}, {'poisson': self.log(1e-3, 1)}])}
        if self.maybe(0.2):
            tables['self_collision'] = {'radius': self.log(1e-4, 0.1), 'overlap': True}
        lines = [f'summary = {toml(self.text())}']
        for name, table in tables.items():
            lines += [f'[{name}]'] + [f'{key} = {toml(value)}' for key, value in table.items()]
        several = [('collider', self.collider(body)) for _ in range(r.choice([0, 0, 1, 2]))]
        if cloth.get('pins') and self.maybe(0.2):
            several.append(('pin_motion', {'vertices': cloth['pins'][:1], **self.motion()}))
        for name, table in several:
            lines += [f'[[{name}]]'] + [f'{key} = {toml(value)}' for key, value in table.items()]
        return '\n'.join(lines) + '\n'

    def body(self):
        """A closed body: an octahedron with displaced corners, or a prism with a notch."""
        if self.maybe():
            corners = [[x * self.random.uniform(0.3, 1.5) for x in corner]
                       for corner in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
            faces = [(1, 3, 5), (3, 2, 5), (2, 4, 5), (4, 1, 5), (3, 1, 6), (2, 3, 6), (4, 2, 6), (1, 4, 6)]
        else:
            notch = self.random.uniform(-0.5, 0.9)
            corners = [[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (0, notch), (-1, 1))]
            faces = [(5, 4, 3, 2, 1), (6, 7, 8, 9, 10)] + [(k + 1, (k + 1) % 5 + 1, (k + 1) % 5 + 6, k + 6) for k in range(5)]
        lines = [f'v {x:g} {y:g} {z:g}' for x, y, z in corners] + [f'f {" ".join(map(str, face))}' for face in faces]
        return '\n'.join(lines) + '\n'

    def obj(self):
        n, lines = self.random.randint(2, 5), []
        for j in range(n):
            lines += [f'v {i / n:g} {j / n:g} {self.random.gauss(0, 0.1):g}' for i in range(n)]
        for j in range(n - 1):
            for i in range(n - 1):
                a = j * n + i + 1
                quad = [a, a + 1, a + n + 1, a + n]
                lines += [f'f {" ".join(map(str, quad))}'] if self.maybe() else [f'f {a} {a + 1} {a + n}', f'f {a + 1} {a + n + 1} {a + n}']
        return '\n'.join(lines) + '\n'

    def solver(self, solvers):
        one = self.random.choice(solvers)
        chosen = []
        for param in one['params']:
            if not self.maybe(0.3):
                continue
            ends = param['allowed'].split(' to ')
            if len(ends) == 1:
                value = self.random.choice(ends[0].split('|'))
            else:
                low, high = float(ends[0]), min(float(ends[1]), 40)
                values = [param['default'], self.random.randint(round(low), round(high))]
                if any(c in param['default'] + param['allowed'] for c in '.e'):  # otherwise it may be an integer
                    values.append(f'{self.random.uniform(low, high):.3g}')
                value = self.random.choice(values)
            chosen.append(f"{param['name']}={value}")
        return one['name'] + (':' if chosen else '') + ','.join(chosen)

    def study(self, scenes, solvers):
        lines = [f'question = {toml(self.text())}', f'scenes = {toml(scenes)}', f'solvers = {toml(solvers)}', 'set = ["time.duration=0.1"]', '[axes]',
                 f'"time.dt" = {toml(self.random.sample(["1/64", "1/32", 0.1, 0.02, 1e-3], 2))}']
        kinds = ['convergence', 'work-precision', 'contact', 'stability', 'scaling', 'series']
        for _ in range(self.random.randint(0, 2)):
            lines += ['[[plot]]', f'kind = "{self.random.choice(kinds)}"', f'title = {toml(self.text())}']
            if self.maybe(0.3):
                lines.append(f'file = {toml(self.text())}')
        return '\n'.join(lines) + '\n'
