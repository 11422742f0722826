#pragma once

/// Docstrings for help(). The first line of a function's docstring is its signature in the form
/// that Python parses.
namespace taut::python::doc {

inline constexpr const char* kInputError =
    R"(Bad input: a scene, a solver's text, an array, a class. Nothing was run.

Its text has a line for every error; `diagnostics` is a list of taut.Diagnostic with file,
line, column and message. A numerical failure is no exception: Run.status.)";

inline constexpr const char* kDiagnostic = "One thing that is wrong with an input.";

inline constexpr const char* kScene =
    R"(What is simulated: a cloth, its pins, links and forces, in SI units. Made by taut.scene().

Immutable. n vertices, m links, f faces, p pins; each array is a copy, so keep what a loop needs.)";

inline constexpr const char* kRun =
    R"(The run of a scene under a solver, or of another program's positions.

T frames of n vertices. A run that explodes ends there: its frames are the stable ones before, its
values NaN, and `verdict` says what happened. A scene that the solver would misread is 'unsupported'
and has no frames.)";

inline constexpr const char* kReplace =
    R"(replace($self, /, settings)
--

The same scene with other settings: scene.replace({"cloth.grid": [8, 8]}).

settings: keys of scene files (`taut list keys`) with numbers, texts, lists or dicts of them.
Returns a new taut.Scene. Raises taut.InputError with all errors.)";

inline constexpr const char* kPinPositions =
    R"(pin_positions($self, /, t)
--

Positions that the pins must have at time t [s]: (p, 3) m, in the order of `pins`.)";

inline constexpr const char* kSurface =
    R"(surface($self, /, collider, x, t)
--

Distances and normals of points with respect to a collider.

collider: its place in `colliders`, from 0. x: (n, 3) m. t: s.
Returns distances (n,) m to its surface, negative inside, and unit normals (n, 3).)";

inline constexpr const char* kSceneFunction =
    R"(scene(source, settings=None, *, name='scene')
--

Reads a scene.

source    a shipped name ("hang": taut.scenes()), a path, TOML text (it has a line break), or a
          taut.Scene. Its keys: experiments/scenes/README.md, `taut list keys`.
settings  values that replace those of the source: {"cloth.grid": [16, 16], "time.dt": "1/60"}.
          Numbers, texts, bools, lists, arrays and dicts of them.
name      of a text, in messages: "<name>.toml:3:1: ..."; its mesh is looked for in this folder.

Returns a taut.Scene. Raises taut.InputError with file, line, column and key of every error.

    scene = taut.scene("hang", {"cloth.grid": [16, 16]}))";

inline constexpr const char* kSimulate =
    R"(simulate(scene, solver='jakobsen', *, dt=None, duration=None, every=1)
--

Runs a solver through a scene, with every metric and the verdict at every step: the same bits as
`taut case SCENE SOLVER --trajectory run.npy`.

scene     a taut.Scene, or what taut.scene() takes.
solver    "name" or "name:key=value,...", as on the command line; taut.solvers() lists them, and
          those of taut.solver() are found, too. Bullet's float build is a program of its own:
          `taut case` runs bullet:precision=float.
dt        s, time step: a number or a text such as "1/60"; None: the scene's.
duration  s; None: the scene's.
every     steps between two frames of Run.x and Run.series, the start and the end included; 0: none.

Returns a taut.Run; a numerical failure is its status. Raises taut.InputError for bad input,
and whatever a solver of taut.solver() raises, with a note that says where. Other threads run
meanwhile; Ctrl-C ends it after the step.

    run = taut.simulate("hang", "jakobsen:iterations=8", duration=2)
    run.status, run.values["stretch.rms"], run.x.shape)";

inline constexpr const char* kVerify =
    R"(verify(solver)
--

The conformance suite: one test with a closed form for each phenomenon, as `taut verify --suite` runs it.

solver  a solver's text, "jakobsen" or "mine:iterations=8"; also one that taut.solver() made.

Returns a list of dicts, a number each, elementary phenomena first: phenomenon, test, needs, verdict
('passed', 'deviates', 'not applicable', 'broken'), quantity, unit, value, closed_form, ratio (nan
where the closed form is 0), tolerance, why. What the solver's unsupported() refuses is 'not
applicable'; what its methods raise breaks the test that called them.

Raises InputError if there is no such solver.)";

inline constexpr const char* kPredict =
    R"(predict(scene, solver='jakobsen', *, dt=None, error=None, stiffness=None, budget=None, as_stiffness=False)
--

Strain of the cloth at rest without running the scene, as `taut predict` finds it.

scene, solver, dt  as in taut.simulate().
error         RMS strain: the fewest sweeps, and the fewest substeps, that have at most this.
stiffness     N/m: those whose cloth stretches like links of this stiffness.
budget        s of CPU time a step: the most that take at most this.
as_stiffness  also find the stiffness of links that stretch like each setting.

Returns a list of dicts, of the setting itself or of the two that were looked for: solver, refused
(reasons, a list of texts; if there are any, all numbers are NaN), rms and largest strain, sag [m],
cpu [s a step, timed on the first ones], stiffness [N/m], c and s of the law
(core/reference/strain_at_rest.hpp). Raises taut.InputError for bad input, and if more than one of
error, stiffness and budget is given.

    taut.predict("hang", "jakobsen:projection=exact", error=0.01)[0]["solver"])";

inline constexpr const char* kScore =
    R"(score(scene, positions, *, fps=None, scale=1.0, up='y', rest=None, every=1, allow_nan=False)
--

Every metric of positions that another program computed, as `taut external score` finds them.

scene      a taut.Scene, or what taut.scene() takes; it gets the frames' time step, and their
           duration if they end earlier.
positions  (T, n, 3) float64 or float32, the start first, in any memory order; one that is not
           contiguous is copied. Or the path of a file: .npy, .pc2, .obj.
fps        frames in a second; None: one a step of the scene.
scale      m per unit: 0.01 for centimetres.
up         the axis that points up: "y" or "z".
rest       (n, 3): the cloth at rest in the order of `positions`, if they do not begin as the scene
           does; None: each vertex of the first frame is the one of the scene that starts there.
every      frames between two of Run.x and Run.series; 0: none.
allow_nan  a coordinate that is not finite ends the run as 'exploded' there; False: it raises.

Returns a taut.Run whose x is in m, y up, in the scene's order; how the array was read is in
Run.record["resolved_settings"]. Velocities are differences between frames. Raises taut.InputError
for another shape or type, a coordinate that is not finite, a first frame that is not the scene's
start, and a pin that is not where the scene holds it.

    taut.score("hang", numpy.load("mine.npy"), fps=24).values["stretch.rms"])";

inline constexpr const char* kSolvers =
    R"(solvers()
--

All solvers, a dict each: name, summary, source, parameters (name, default, unit, choices, help).)";

inline constexpr const char* kMetrics =
    R"(metrics()
--

All values that metrics yield, a dict each: name, unit, help, window (of the run: 'last second',
'whole run', 'end of the run'), in_series, metric.)";

inline constexpr const char* kScenes =
    R"(scenes()
--

All shipped scenes, a dict each: name, summary, vertices, links, dt and duration [s].)";

}  // namespace taut::python::doc
