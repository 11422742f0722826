#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/solver/simd/contact.hpp"

namespace taut {

/// An interleaved sheet (array of structures of arrays) is a regular sheet cut into `lanes` strips
/// of columns, a lane for each. A SIMD vector holds the same column of every strip: column c is
/// lane c / K of vector c % K, where K = ceil(nu / lanes).
///
///     one row:  | x of columns 0, K, 2K, .. | y of them | z of them | x of 1, K+1, .. | ...
///
/// All links of a row in one direction are then pairs of whole vectors. Only at the end of a strip,
/// where column K-1 meets column K, does a vector pair up with its neighbour shifted by a lane.
/// Wide sheets have 16 lanes, which AVX-512 takes at once, others 8: the order of the links depends
/// on the sheet and not on the machine.
inline constexpr int kNarrow = 8, kWide = 16;
/// Number of links in a batch.
inline constexpr int kLanes = 8;
/// Sizes of the blocks that threads share, in rows of a sheet and in kLanes packed particles.
/// Either way a block is a multiple of kGrain numbers.
inline constexpr int kBlockRows = 8, kBlockBatches = 96;

/// The rows of an interleaved sheet in memory. Lanes past the last column and vectors past the last
/// one are padding.
struct SheetRows {
  int rows = 0, columns = 0, lanes = 1;
  int vectors = 0;         ///< K
  std::size_t stride = 0;  ///< numbers from one row to the next
};

/// Links of one direction that start in one row.
template <class Real>
struct SheetRow {
  /// [K][2][lanes] shares of the left and of the right end; 0: no link. Compliant links have
  /// [K][3][lanes], the last for the multiplier (compliant_excess).
  const Real* shares;
  /// All links have SheetDirection::equal_share, except those at the end of the strips and those
  /// between padding, which may have any.
  bool all_equal;
};

/// Links (i, j) - (i + columns, j + ..) of one direction; `left` is the end in the lesser column.
template <class Real>
struct SheetDirection {
  int left, right;            ///< rows of the two ends, counted from the row that owns the link
  int columns;                ///< 0, 1 or 2
  int rows;                   ///< number of rows that own links
  Real rest;                  ///< m
  Real equal_share;           ///< of each end of links between equal masses
  Real multiplier_share;      ///< of compliant links between equal masses
  Real* multipliers;          ///< m: [rows][K][lanes] of compliant links; null: rigid
  const SheetRow<Real>* row;  ///< [rows]
};

template <class Real>
struct SheetSweep {
  int lanes;           ///< kNarrow or kWide
  int vectors;         ///< K
  std::size_t stride;  ///< numbers from one row to the next
  int directions;
  SheetDirection<Real> direction[6];
};

/// kLanes links of packed particles, no two with a common vertex. A large sheet takes as long as
/// its links take to come from memory, so links between neighbours have short numbers.
template <class Real, class Number>
struct Batch {
  Number a[kLanes], b[kLanes];  ///< places of particles
  Real rest[kLanes];
};
template <class Real>
using NearBatch = Batch<Real, std::uint16_t>;  ///< ends count from the first particle of the run
template <class Real>
using FarBatch = Batch<Real, std::uint32_t>;

/// A run of batches. Links between equal masses have one share; others have a table.
template <class Real>
struct BatchRun {
  const NearBatch<Real>* near;  ///< [count], or null: `far` has them
  const FarBatch<Real>* far;
  std::size_t count;
  std::size_t first;   ///< particle from which near ends count
  std::size_t ahead;   ///< first number of x that the next tile needs
  std::size_t stride;  ///< from one batch's `ahead` to the next: a cache line, or 0
  Real equal_share, multiplier_share;
  /// [count][2][kLanes], for compliant links [count][3][kLanes]; null: all are equal.
  const Real* shares;
  Real* multipliers;  ///< m: [count][kLanes] of compliant links; null: rigid
};

/// Length after which VerletStep::g repeats. Arrays of numbers have a multiple of it.
inline constexpr std::size_t kGrain = 48;
/// One step of Verlet: adds keep (x - previous) + g (+ a dt2, and clears a) to x; previous becomes
/// the old x. x, previous, a: [length] numbers, length a multiple of kGrain.
template <class Real>
struct VerletStep {
  Real *x, *previous, *a;  ///< a null: no forces
  Real keep, dt2;
  const Real* g;  ///< [kGrain] m
};

/// Wind in the form that the loops need: core/model/wind.hpp in the solver's precision.
template <class Real>
struct WindStep {
  const Real *x, *previous;  ///< [length]
  Real* a;                   ///< the wind's acceleration is added
  Vec3T<Real> velocity;      ///< m/s
  Real per_moved;  ///< velocity of a face over the sum of its corners' motions; 0: not read
  Real sixth;      ///< a sixth of the strength
};
/// The faces of an interleaved sheet, two in each quad.
template <class Real>
struct SheetFaces {
  int vectors;         ///< K
  std::size_t stride;  ///< numbers from one row to the next
  /// [K][lanes] of even and of odd rows of quads: 1 if their diagonal begins at (i, j), -1 if at (i
  /// + 1, j), 0 if there is no quad.
  const Real* diagonals[2];
  const Real* w;  ///< [rows][K][lanes] 1/kg
};
/// kLanes faces of packed particles.
template <class Real>
struct FaceBatch {
  std::uint32_t corner[3][kLanes];  ///< places of particles
  Real w[3][kLanes];                ///< 1/kg
};

/// kLanes packed particles, no two of which are joined by a link, a bending element or a triangle
/// of a membrane. Their links are in slots [first_slot, end_slot), each with one link of every
/// lane. A lane without a particle has one of the spare ones of Layout::packed.
struct VertexGroup {
  PackedSlot particle[kLanes];
  std::uint32_t first_slot, end_slot;
};
/// One link for each lane. A lane without a link has one of no length from its particle to itself,
/// which does nothing.
template <class Real>
struct SpringSlot {
  PackedSlot other[kLanes];  ///< other end of the link
  Real rest[kLanes];         ///< m
  Real stiffness[kLanes];    ///< N/m
};
/// Slot of an augmented Lagrangian (avbd.cpp). Both ends of a link keep its numbers and compute the
/// same bits, so that nothing is carried from one to the other.
template <class Real>
struct AugmentedSlot : SpringSlot<Real> {
  Real multiplier[kLanes];  ///< N
  Real left[kLanes];        ///< m, alpha C_0
};

/// Slot of alternating directions (admm.cpp). Both ends of a link keep its multiplier, each as seen
/// from its own end.
template <class Real>
struct MultiplierSlot : SpringSlot<Real> {
  Real multiplier[3][kLanes];  ///< m, u
  Real share[kLanes];          ///< 1/(1 + k/K)
};

/// Input of a sweep over vertices, and x, which it moves. Arrays of numbers are packed.
template <class Real>
struct VertexSweep {
  const VertexGroup* groups;
  Real* x;
  const Real* y;         ///< positions without links
  const Real* previous;  ///< x_t
  const Real* inertia;   ///< [groups][kLanes] m/h^2 [N/m]
  const Real* bending;   ///< [groups][4][kLanes] force x, y, z [N], Hessian [N/m]; null: none
  /// [groups][9][kLanes] force x, y, z [N], Hessian xx, yy, zz, xy, xz, yz [N/m]; null: none
  const Real* membrane;
  const Real* held;  ///< [groups][3][kLanes] force of contact [N]; null: none
  Real* hessian;     ///< [groups][6][kLanes] N/m, xx, yy, zz, xy, xz, yz, is set; null: none
  Real damping;      ///< k_d/h of the springs
};
template <class Real>
struct AugmentedStep {
  const VertexGroup* groups;
  AugmentedSlot<Real>* slots;
  const Real *x, *previous;
  Real alpha, beta, gamma, k_min, k_max;  ///< see avbd.cpp
};

/// Input from which forces on vertices are computed. Arrays of numbers are packed.
template <class Real>
struct ForceSweep {
  const VertexGroup* groups;
  const Real *x, *y;    ///< m; y: positions without links
  const Real* inertia;  ///< [groups][kLanes] m/h^2 [N/m]
  double* rows;         ///< N, receives the forces
};
template <class Real>
struct AccelerationSweep {
  const VertexGroup* groups;
  const Real *x, *previous;
  const Real* w;  ///< [groups][kLanes] 1/kg
  Real* a;        ///< accelerations are added to it
  Real drag;      ///< N/m, force per displacement since the step before
};

/// Columns of a sparse factor that are stored as a dense matrix (panel_factor.hpp).
struct FactorPanel {
  std::uint32_t first, columns;   ///< unknowns
  std::uint32_t first_row, rows;  ///< first of the rows below, and their number
  std::size_t first_value;
};
/// Largest number of columns of a panel of single numbers.
inline constexpr std::uint32_t kWidestPanel = 4;
struct PanelSolve {
  const FactorPanel* panels;
  std::size_t count;
  const std::uint32_t* row;
  const double* values;
};

/// All particles, either of an interleaved sheet or, with one lane, packed.
template <class Real>
struct ParticleSpan {
  Real* x;
  const Real* previous;
  SheetRows sheet;
  std::size_t particles;

  /// Number of parts that can be computed independently: rows of a sheet, or kLanes packed
  /// particles each.
  std::size_t parts() const {
    return sheet.lanes > 1 ? static_cast<std::size_t>(sheet.rows)
                           : (particles + kLanes - 1) / kLanes;
  }
  /// The first part of a block.
  std::size_t part_of_block(std::size_t block) const {
    const std::size_t part = block * (sheet.lanes > 1 ? kBlockRows : kBlockBatches);
    return part < parts() ? part : parts();
  }
};
/// Pushes out of the collider what is inside or, if continuous, has passed through it in this step;
/// for the parts [begin, end).
template <class Real, template <class> class SurfaceOf>
using Collide = void (*)(const Contact<Real, SurfaceOf>&, const ParticleSpan<Real>&,
                         std::size_t begin, std::size_t end);
template <class Real>
struct CollideKernels {
  Collide<Real, PlaneSurface> plane;
  Collide<Real, BallSurface> ball, ball_continuous;
  Collide<Real, BoxSurface> box, box_continuous;
  Collide<Real, CapsuleSurface> capsule, capsule_continuous;
};

/// One tether of each particle, in the particles' layout: its pin and, where x is, its length [m];
/// kNoTether: none.
template <class Real>
struct TetherTable {
  const Real *pin, *length;
};
/// Longer than any tether [m]; a float holds its square.
inline constexpr double kNoTether = 1e18;

/// Bounds of the motions of all particles [m].
template <class Real>
struct MotionBox {
  Vec3T<Real> least, most;
};
template <class Real>
struct MotionBoxes {
  MotionBox<Real> since_previous, since_then;
};

/// Most particles that a search looks at together.
inline constexpr std::uint32_t kSearchLanes = 8;

/// A particle for each lane, from `first` on, with a bit in `mask` for each that counts.
struct SearchBlock {
  std::uint32_t first, mask;
};
/// Two particles that may touch in this step.
struct CandidatePair {
  std::uint32_t a, b;
};

/// Particles sorted by the cells of a grid (contact/neighbour_grid.hpp), and what to search for.
template <class Real>
struct NeighbourSearch {
  /// [particles + kSearchLanes] x, y, z [m] of each particle: its position, its motion in the step,
  /// and its position at rest.
  const Real *now[3], *moved[3], *rest[3];
  const std::uint32_t* buckets;           ///< [particles] bucket of each one's cell
  const std::uint32_t* starts;            ///< [bucket_count + 1] first particle of each bucket
  std::uint32_t particles, bucket_count;  ///< the latter is a power of two
  std::uint32_t row, layer;               ///< buckets from a cell to the next in y, and in z
  Real within, ignored;                   ///< m
  bool moving;                            ///< false: no particle has moved, and `moved` is not read
  SearchBlock* blocks;                    ///< scratch: [particles + 10]
  CandidatePair* found;  ///< [room]; one particle needs up to particles + 11 kSearchLanes
  std::size_t room;
};
/// Finds the pairs that are closer than `within` plus their relative motion in the step, unless
/// they are closer than `ignored` at rest. Starts at particle `next`, which it moves on, and stops
/// at `end` or where it might find more than there is room for. Returns the number of pairs.
template <class Real>
using FindPairs = std::size_t (*)(const NeighbourSearch<Real>&, std::uint32_t& next,
                                  std::uint32_t end);

/// The performance-critical loops, compiled once for each instruction set.
template <class Real>
struct Kernels {
  /// Verlet, as wide as the sweep: a few 512-bit instructions in each step slow down the shorter
  /// ones of all its sweeps (a sheet of 32 x 32 by a sixth, batches by 4 %).
  void (*narrow_verlet)(const VerletStep<Real>&, std::size_t begin, std::size_t end);
  void (*wide_verlet)(const VerletStep<Real>&, std::size_t begin, std::size_t end);
  /// Rows [begin, end) of a sweep with kNarrow or kWide lanes; indexed by Projection.
  void (*narrow_sheet[2])(const SheetSweep<Real>&, Real* x, int begin, int end);
  void (*wide_sheet[2])(const SheetSweep<Real>&, Real* x, int begin, int end);
  void (*batches[2])(const BatchRun<Real>&, Real* x);
  /// Sweeps over links that may be compliant; rigid ones are projected exactly. keep: 1, or 0 if
  /// multipliers begin at 0.
  void (*compliant_narrow_sheet)(const SheetSweep<Real>&, Real* x, Real keep, int begin, int end);
  void (*compliant_wide_sheet)(const SheetSweep<Real>&, Real* x, Real keep, int begin, int end);
  void (*compliant_batches)(const BatchRun<Real>&, Real* x, Real keep);
  CollideKernels<Real> collide;
  /// Wind on rows [begin, end) of quads, which touch one row of particles more.
  void (*narrow_wind)(const WindStep<Real>&, const SheetFaces<Real>&, int begin, int end);
  void (*wide_wind)(const WindStep<Real>&, const SheetFaces<Real>&, int begin, int end);
  void (*wind_on_faces)(const WindStep<Real>&, std::span<const FaceBatch<Real>>);
  /// Moves the vertices of groups [begin, end), which have one colour, each to its minimum.
  void (*sweep_springs)(const VertexSweep<Real>&, const SpringSlot<Real>*, std::size_t begin,
                        std::size_t end);
  void (*sweep_augmented)(const VertexSweep<Real>&, const AugmentedSlot<Real>*, std::size_t begin,
                          std::size_t end);
  /// Updates multipliers and stiffnesses of groups [begin, end), at a substep's start and after a
  /// sweep.
  void (*begin_augmented)(const AugmentedStep<Real>&, std::size_t begin, std::size_t end);
  void (*augment)(const AugmentedStep<Real>&, std::size_t begin, std::size_t end);
  /// Sets rows = links + inertia (y - x) for groups [begin, end).
  void (*spring_forces)(const ForceSweep<Real>&, SpringSlot<Real>*, std::size_t begin,
                        std::size_t end);
  void (*multiplier_forces)(const ForceSweep<Real>&, MultiplierSlot<Real>*, std::size_t begin,
                            std::size_t end);
  /// Adds the accelerations of groups [begin, end).
  void (*accelerate)(const AccelerationSweep<Real>&, SpringSlot<Real>*, std::size_t begin,
                     std::size_t end);
  /// Turns a panel of `columns` columns with `rows` rows below them into its factor, and subtracts
  /// its part for these rows from the lower triangle of `update` [side][side]. Returns false if a
  /// pivot is not positive. scratch: [2][columns][side]; side: a multiple of 8.
  bool (*eliminate)(double* panel, std::size_t columns, std::size_t rows, double* update,
                    std::size_t side, double* scratch);
  /// Replaces [unknowns][4] right-hand sides by their solutions.
  void (*solve_panels)(const PanelSolve&, double* rows);
  /// Pulls particles back to their tether's length if they are farther from their pin, table after
  /// table; indexed by Projection.
  void (*tethers[2])(const ParticleSpan<Real>&, std::span<const TetherTable<Real>>);
  /// Bounds of the motions of the parts [begin, end) and of the first particle: since the span's
  /// `previous`, and since `then`, which has the same layout.
  MotionBoxes<Real> (*motion_boxes)(const ParticleSpan<Real>&, const Real* then, std::size_t begin,
                                    std::size_t end);
  /// Square of the largest motion relative to `middle` in the parts [begin, end) [m^2].
  Real (*largest_motion2)(const ParticleSpan<Real>&, const Vec3T<Real>& middle, std::size_t begin,
                          std::size_t end);
  FindPairs<Real> find_pairs;
  /// Projects independent pairs without loading or storing anything, to measure the arithmetic
  /// alone in benchmarks. Sets the number of projections.
  Real (*in_registers)(Real rest, int rounds, int& projections);
  /// Loads and stores what batches do and hardly computes, to measure what moving the particles
  /// costs.
  void (*load_and_store)(const BatchRun<Real>&, Real* x);
};

enum class Simd { scalar, sse2, avx2, avx512 };
std::string_view to_string(Simd);

/// Whether this program was built for the instruction set and this machine has it.
bool available(Simd);
/// The widest instruction set that is available.
Simd widest();

/// The kernels for an instruction set. All of them compute the same bits. Precondition: available.
template <class Real>
const Kernels<Real>& kernels(Simd);

/// The kernels that instruction_set.cpp makes for one instruction set.
template <Simd, class Real>
const Kernels<Real>& kernels_for();

}  // namespace taut
