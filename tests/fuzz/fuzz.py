#!/usr/bin/env python3
"""Runs the built program with generated and damaged inputs: fuzz.py BUILD [--seconds N] [--seed S] [--only KIND[:NUMBER]|KIND,KIND...].

Each attempt has a folder of its own with inputs and one or two commands. A finding is a signal, an undocumented exit code, a refusal
without a message, a run that does not end, output that is not strict JSON, a non-finite number, or a file that a text of an input
created. The folder of a finding is kept and printed with the command; `--seed S --only KIND:NUMBER` repeats an attempt."""

import argparse
import json
import os
import pathlib
import random
import resource
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

from generate import NASTY, Maker, mutate, toml

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / 'cli'))
import stored  # noqa: E402

CODES = {0, 1, 2, 3, 4, 5, 6, 130}  # experiments/command_line/verb.hpp
STATUSES = set()  # filled by main()
LEGITIMATE = 30  # the largest legitimate_strain() of any scene: experiments/case/divergence.cpp
SECONDS = 60  # s, limit of a command; more counts as a hang
SOURCES = pathlib.Path(__file__).resolve().parents[2]
SMALL = ('[cloth]\ngrid = [3, 3]\nsize = [1, 1]\nmass = 0.1\npins = ["top-left"]\n'
         '[time]\ndt = "1/32"\nduration = 0.1\n')
PLOTS = '[[plot]]\nkind = "convergence"\n[[plot]]\nkind = "series"\ny = "stretch.rms"\n'
STUDY = 'question = "?"\nscenes = ["./small.toml"]\nsolvers = ["jakobsen", "xpbd"]\n[axes]\niterations = [1, 2]\n' + PLOTS


class Finding(Exception):
    pass


def strict(text):
    """Parses JSON without NaN and infinities."""
    def refuse(word):
        raise Finding(f'{word} in JSON')
    try:
        return json.loads(text, parse_constant=refuse)
    except ValueError as error:
        raise Finding(f'no JSON: {error}') from error


def judge_record(record):
    status = record['status']['kind']
    if status not in STATUSES:
        raise Finding(f'status {status}')
    if status == 'crash':
        raise Finding(f"a case crashed: {record['status']['reason']}")
    if status in ('ok', 'unsettled', 'extreme') and len(record['digest']) != 64:
        raise Finding('a completed case without a final state')
    if status in ('ok', 'unsettled') and (record['values'].get('stretch.peak') or 0) > LEGITIMATE:
        raise Finding(f"{status} with a strain of {record['values']['stretch.peak']}")
    if not record['dt'] > 0:
        raise Finding('a time step that is not above 0')


class Attempt:
    def __init__(self, build, folder, seed):
        self.build, self.folder, self.random = build, folder, random.Random(seed)
        self.sanitized = 'TAUT_SANITIZE:BOOL=ON' in (build / 'CMakeCache.txt').read_text()
        self.make = Maker(self.random)
        self.last, self.codes = '', []

    def write(self, name, data):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data.encode('utf-8', 'surrogatepass') if isinstance(data, str) else data)

    def taut(self, *words):
        """Runs the command in this folder and returns its output."""
        words = [str(word) for word in words]
        self.last = f'cd {shlex.quote(str(self.folder))} && {shlex.join([str(self.build / PROGRAM), *words])}'

        def limit():
            if not self.sanitized:  # shadow memory alone takes terabytes
                resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        process = subprocess.Popen([self.build / PROGRAM, *words], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, start_new_session=True, preexec_fn=limit)
        try:
            out, err = process.communicate(timeout=SECONDS * (5 if self.sanitized else 1))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise Finding(f'no end within {SECONDS} s') from None
        if process.returncode not in CODES:
            raise Finding(f'exit code {process.returncode}: {err.decode(errors="replace")[-600:]}')
        if process.returncode == 2 and not err.strip():
            raise Finding('exit code 2 without a word')
        for sign in (b'terminate called', b'Sanitizer', b'runtime error', b'Assertion'):
            if sign in err:
                raise Finding(err.decode(errors='replace')[-600:])
        if b'\x1b' in err + out:
            raise Finding('a raw escape reaches the terminal')
        if list(self.folder.rglob('canary')) or (self.folder.parent / 'canary').exists():
            raise Finding('a text of the input was executed or is a path')
        self.codes.append(process.returncode)
        return out.decode(errors='replace')

    def run(self, *words):
        limits = ['--timeout', 20, '--memory', 1 << 26] if self.sanitized else ['--timeout', 2, '--memory', 500]
        said = self.taut('run', *words, *limits, '-j', 1, '--json')
        if self.codes[-1] == 0:
            strict(said)
        if self.codes[-1] == 0:
            for record in stored.records(self.folder / 'results/runs'):
                judge_record(record)

    def solver(self):
        return self.make.solver(SOLVERS)

    def stored(self):
        """Results of a small study that was run and benched, made once and copied for each attempt."""
        template = self.folder.parent / 'stored'
        if not template.exists():
            whole = Attempt(self.build, template, 0)
            whole.write('small.toml', SMALL)
            whole.write('study.toml', STUDY)
            whole.taut('run', './study.toml')
            whole.taut('bench', './study.toml', '--rounds', 2, '--seconds', 0.001)
            whole.taut('baseline', 'update', './study.toml', '--baselines', 'baselines', '--why', 'fuzz')
            if any(whole.codes):
                raise RuntimeError(f'the study that is to be damaged did not run: {whole.codes}')
        shutil.copytree(template, self.folder, dirs_exist_ok=True)

    def look(self):
        """Every verb that reads a results folder."""
        verb = self.random.choice(['export', 'plot', 'report', 'run', 'merge'])
        if verb == 'report':
            if said := self.taut('report', './study.toml', '--json'):
                strict(said)
        elif verb == 'run':
            self.run('./study.toml')
        elif verb == 'merge':
            self.taut('cluster', 'merge', 'results/runs', '--out', 'merged')
        else:
            self.taut(verb, './study.toml')


def scene_made(attempt):
    name = attempt.random.choice(['made.toml', 'made.toml', '<b>&"\'`id`.toml', '\u202egpj.toml', '=1+1.toml', '$(touch canary).toml'])
    attempt.write(name, attempt.make.scene(body='body.obj'))
    attempt.write('body.obj', attempt.make.body())
    attempt.write('study.toml', f'question = "?"\nscenes = {toml(["./" + name])}\nsolvers = {toml([attempt.solver()])}\n')
    attempt.taut('plan', './' + name, attempt.solver(), '--json')
    attempt.run('./study.toml')
    if attempt.codes[-1] == 0:
        attempt.taut('export', './study.toml')
        attempt.taut('plot', './study.toml', '--kind', 'series', '--y', 'stretch.rms')


def scene_damaged(attempt):
    folder = SOURCES / 'experiments/scenes'
    files = sorted(folder.glob('*.toml')) + sorted(folder.glob('torture/*.toml'))
    text = mutate(attempt.random, attempt.random.choice(files).read_bytes(), 2)
    attempt.write('damaged.toml', text)
    small = [] if b'mesh' in text else ['--set', 'cloth.grid=[4, 3]']
    attempt.taut('plan', './damaged.toml', attempt.solver(), '--json', *small)
    attempt.taut('case', './damaged.toml', attempt.solver(), '--dt', '1/64', '--duration', '0.1', '--json', *small)


def mesh(attempt):
    text = attempt.make.obj()
    attempt.write('made.obj', mutate(attempt.random, text.encode()) if attempt.make.maybe(0.4) else text)
    attempt.write('made.toml', attempt.make.scene(mesh='made.obj'))
    said = attempt.taut('case', './made.toml', attempt.solver(), '--dt', '1/64', '--duration', '0.1', '--json')
    if attempt.codes[-1] == 0:
        judge_record(strict(said))


def solver(attempt):
    attempt.write('small.toml', SMALL)
    text = attempt.solver().encode()
    text = mutate(attempt.random, text).replace(b'\0', b'').decode('utf-8', 'surrogateescape') if attempt.make.maybe() else text.decode()
    said = attempt.taut('plan', './small.toml', '--json', '--', text)
    if attempt.codes[-1] == 0:
        strict(said)


def study_made(attempt):
    attempt.write('small.toml', SMALL)
    text = attempt.make.study(['./small.toml'], [attempt.solver() for _ in range(attempt.random.randint(1, 3))]).encode()
    attempt.write('study.toml', mutate(attempt.random, text) if attempt.make.maybe(0.4) else text)
    attempt.run('./study.toml')
    if attempt.codes[-1] == 0:
        attempt.taut('plot', './study.toml')
        attempt.taut('report', './study.toml', '--json')


def study_damaged(attempt):
    files = sorted((SOURCES / 'experiments/studies').glob('*.toml'))
    attempt.write('study.toml', mutate(attempt.random, attempt.random.choice(files).read_bytes(), 2))
    attempt.run('./study.toml', '--shard', '1/99991')  # reads everything, runs almost nothing


def arguments(attempt):
    """Texts in place of names, numbers or files on the command line."""
    attempt.write('small.toml', SMALL)
    attempt.write('study.toml', STUDY)
    texts = NASTY + ['-1', 'nan', '1e999', '0', '99999999999999999999', '1/0', '', 'x' * 5000, '/dev/null', '/', '.', './study.toml']
    words = {'case': ['./small.toml', 'jakobsen'], 'plan': ['./small.toml', 'jakobsen'], 'run': ['./study.toml'], 'export': ['./study.toml'],
             'plot': ['./study.toml'], 'cluster merge': ['results'], 'cluster submit': ['./study.toml', '--on', 'slurm', '--dry-run'],
             'external score': ['./small.toml', './small.toml'], 'require': ['./small.toml', 'jakobsen'], 'check': ['./study.toml'],
             'list': ['scenes'], 'new': ['scene', 'x'], 'report': ['./study.toml'], 'frontier': ['./small.toml', 'jakobsen'], 'render': ['./small.toml']}
    verb = attempt.random.choice(sorted(words))
    given = words[verb]
    option = attempt.random.choice(['--dt', '--duration', '--set', '--preset', '--shard', '--only', '--timeout', '--memory', '-j', '--table',
                                    '--kind', '--y', '--out', '--baselines', '--at', '--size', '--view', '--of', '--from', '--to', ''])
    text = attempt.random.choice(texts)
    if option:
        given = given + [option, text]
    else:
        given = given[:-1] + [text]
    attempt.taut(*verb.split(), *given)


def damage(attempt, pattern):
    attempt.stored()
    files = sorted(attempt.folder.glob(pattern))
    file = attempt.random.choice(files)
    file.write_bytes(mutate(attempt.random, file.read_bytes(), 4))
    return file


def record(attempt):
    """Damages bytes of the file, or a cell of a table, which SQLite considers sound."""
    if attempt.make.maybe(0.4):
        damage(attempt, 'results/runs/results.db')
    else:
        attempt.stored()
        results = attempt.folder / 'results/runs'
        table = attempt.random.choice(['cases', 'cases', 'cases', 'numbers', 'series', 'metrics', 'planned', 'sessions', 'benches', 'timings', 'samples'])
        column = attempt.random.choice([row['name'] for row in stored.query(results, f'PRAGMA table_info({table})')])
        old = stored.query(results, f'SELECT {column} FROM {table} LIMIT 1')[0][0]
        new = old
        if isinstance(old, str):
            new = mutate(attempt.random, old.encode(), 4).decode('utf-8', 'replace')
        elif not column.endswith('_id'):
            new = attempt.random.choice([None, -1, 2**62, 1e308, 0.5, 'x', b'\xff', '', 0])
        try:
            stored.change(results, f'UPDATE {table} SET {column} = ? WHERE {column} IS ?', new, old)
        except sqlite3.IntegrityError:
            pass
    attempt.look()


def baseline(attempt):
    damage(attempt, 'baselines/*/*')
    said = attempt.taut('check', './study.toml', '--baselines', 'baselines', '--json', '-j', 1)
    if attempt.codes[-1] in (0, 1, 3, 4):
        strict(said)


def probe(attempt):
    """An external solver with one damaged answer. Returns it as a solver's text."""
    attempt.write('small.toml', SMALL)
    hostile = SOURCES / 'tests/external/hostile.py'
    text = f'''external:cmd='python3 "{hostile}" random {attempt.random.randrange(10**9)}',timeout=1'''
    attempt.taut('external', 'probe', text, '--json')
    return text


def program(attempt):
    text = probe(attempt)
    attempt.write('study.toml', f'question = "?"\nscenes = ["./small.toml"]\nsolvers = {toml([text, "jakobsen"])}\n')
    attempt.run('./study.toml')


def listed(build, what, *names):
    """The rows of these tables of `taut list`."""
    tables = json.loads(subprocess.run([build / PROGRAM, 'list', what, '--json'], capture_output=True, check=True).stdout)['tables']
    return [[dict(zip((column['name'] for column in tables[name]['columns']), row)) for row in tables[name]['rows']] for name in names]


def listed_statuses(build):
    """What a record may have as its status."""
    (fields,) = listed(build, 'record', 'record')
    return next(row['help'] for row in fields if row['key'] == 'status.kind').split(', ')


def listed_solvers(build):
    """[{'name': 'bullet', 'params': [{'name': ..., 'default': ..., 'allowed': ...}]}]"""
    solvers, parameters = listed(build, 'solvers', 'solvers', 'parameters')
    return [one | {'params': [p for p in parameters if p['solver'] == one['name']]} for one in solvers]


KINDS = {each.__name__: each for each in (scene_made, scene_damaged, mesh, solver, study_made, study_damaged, arguments, record,
                                          baseline, program, probe)}
SOLVERS = []
PROGRAM = 'taut'


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--seconds', type=float, default=60)
    parser.add_argument('--seed', default=str(random.SystemRandom().randrange(10**9)))
    parser.add_argument('--only', default='', help='a kind, with the number of an attempt; or kinds')
    parser.add_argument('--program', default='taut', help="the program's name within BUILD")
    parser.add_argument('--most', type=int, default=5, help='findings before it stops')
    options = parser.parse_args()
    build = options.build.resolve()
    kind, _, number = options.only.partition(':')
    kinds = kind.split(',') if kind else [each for each in KINDS if each != 'probe']  # which is the half of `program`
    global PROGRAM
    PROGRAM = options.program
    scratch = pathlib.Path(tempfile.mkdtemp(prefix='taut-fuzz.'))
    SOLVERS.extend(listed_solvers(build))
    STATUSES.update(listed_statuses(build))
    print(f'seed {options.seed}', flush=True)
    end, findings, codes = time.monotonic() + options.seconds, 0, {each: {} for each in kinds}
    i = int(number) if number else 0
    while findings < options.most and time.monotonic() < end:
        for each in kinds:
            folder = scratch / f'{each}-{i}'
            folder.mkdir()
            attempt = Attempt(build, folder, f'{options.seed}:{each}:{i}')
            try:
                KINDS[each](attempt)
                shutil.rmtree(folder)
            except Finding as finding:
                findings += 1
                kept = build / 'fuzz-findings' / f'{options.seed}-{folder.name}'
                shutil.rmtree(kept, ignore_errors=True)
                shutil.copytree(folder, kept)
                again = attempt.last.replace(str(folder), str(kept))
                print(f'FINDING {each}: {finding}\n  input   {kept}\n  command {again}\n'
                      f'  again   fuzz.py {build} --program {PROGRAM} --seed {options.seed} --only {each}:{i}', flush=True)
            for code in attempt.codes:
                codes[each][code] = codes[each].get(code, 0) + 1
        i += 1
        if number:
            break
    shutil.rmtree(scratch)
    for each, seen in codes.items():
        print(f'{each:14} ' + ', '.join(f'exit {code}: {count}' for code, count in sorted(seen.items())))
    # For some kinds one attempt in twenty ends differently from the rest: 180 attempts end alike in 1 of 10,000 runs, 40 in one of eight.
    alike = [each for each, seen in codes.items() if i > 20 and len(seen) < 2]
    vacuous = alike and i >= 180
    if alike:
        print('all alike' + (', so nothing was tried: ' if vacuous else ', perhaps by chance: ') + ', '.join(alike))
    return 1 if findings or vacuous else 0


if __name__ == '__main__':
    sys.exit(main())
