#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/solver/simd/contact.hpp"

namespace taut {

/// An interleaved sheet (array of structures of arrays): a regular sheet is cut into `lanes` strips
/// of columns, a lane for each, and a SIMD vector holds the same column of every strip: column c is
/// lane c / K of vector c % K, where K = ceil(nu / lanes).
///
///     one row:  | x of columns 0, K, 2K, .. | y of them | z of them | x of 1, K+1, .. | ...
///
/// So all links of a row in one direction are pairs of whole vectors; only at the end of a strip,
/// where column K-1 meets column K, does a vector pair up with its neighbour shifted by a lane.
/// Wide sheets have 16 lanes, which AVX-512 takes at once, others 8: the order of the links depends
/// on the sheet and not on the machine.
inline constexpr int kNarrow = 8, kWide = 16;
/// Links of a batch.
inline constexpr int kLanes = 8;
/// Threads share blocks of so many rows of a sheet, or of so many kLanes packed particles: the
/// numbers of both are a multiple of kGrain.
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
  /// [K][2][lanes] of the left and of the right end; 0: no link. [K][3][lanes] of compliant links:
  /// the last of the multiplier (compliant_excess).
  const Real* shares;
  bool all_equal;  ///< all links have SheetDirection::equal_share, but for those at the end of
                   ///< the strips and those between padding, which may have any
};

/// Links (i, j) - (i + columns, j + ..) of one direction; `left` is the end in the lesser column.
template <class Real>
struct SheetDirection {
  int left, right;            ///< rows of the two ends, counted from the row that owns the link
  int columns;                ///< 0, 1 or 2
  int rows;                   ///< so many rows own links
  Real rest;                  ///< m
  Real equal_share;           ///< of each end between equal masses
  Real multiplier_share;      ///< of compliant links between them
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

/// kLanes links without a common vertex, of packed particles. A large sheet takes as long as its
/// links take to come from memory, so those between neighbours have short numbers.
template <class Real, class Number>
struct Batch {
  Number a[kLanes], b[kLanes];  ///< places of particles
  Real rest[kLanes];
};
template <class Real>
using NearBatch = Batch<Real, std::uint16_t>;  ///< counts from the first particle of its run
template <class Real>
using FarBatch = Batch<Real, std::uint32_t>;

/// Batches between equal masses have one share; others have a table.
template <class Real>
struct BatchRun {
  const NearBatch<Real>* near;  ///< [count], or null: `far` has them
  const FarBatch<Real>* far;
  std::size_t count;
  std::size_t first;   ///< particle from which near ends count
  std::size_t ahead;   ///< number of x that will be needed in the next tile
  std::size_t stride;  ///< of such numbers from one batch to the next: a cache line, or 0
  Real equal_share, multiplier_share;
  /// [count][2][kLanes], of compliant links [count][3][kLanes], or null: all are equal.
  const Real* shares;
  Real* multipliers;  ///< m: [count][kLanes] of compliant links; null: rigid
};

/// x, previous, a: [length] numbers, length a multiple of kGrain. Adds keep (x - previous) + g
/// (+ a dt2, and clears a) to x; previous becomes the old x. g repeats every kGrain numbers.
inline constexpr std::size_t kGrain = 48;
template <class Real>
struct VerletStep {
  Real *x, *previous, *a;  ///< a null: no forces
  Real keep, dt2;
  const Real* g;  ///< [kGrain] m
};

/// Wind as the loops want it: core/model/wind.hpp in the solver's precision.
template <class Real>
struct WindStep {
  const Real *x, *previous;  ///< [length]
  Real* a;                   ///< the wind's acceleration is added
  Vec3T<Real> velocity;      ///< m/s
  Real per_moved;  ///< a face's velocity over the sum of its corners' motions; 0: not read
  Real sixth;      ///< of the strength
};
/// The faces of an interleaved sheet, two in each quad.
template <class Real>
struct SheetFaces {
  int vectors;               ///< K
  std::size_t stride;        ///< numbers from one row to the next
  const Real* diagonals[2];  ///< [K][lanes] of even and odd rows of quads: 1 if theirs begins at
                             ///< (i, j), -1 if at (i + 1, j), 0 where there is no quad
  const Real* w;             ///< [rows][K][lanes] 1/kg
};
/// kLanes faces of packed particles.
template <class Real>
struct FaceBatch {
  std::uint32_t corner[3][kLanes];  ///< places of particles
  Real w[3][kLanes];                ///< 1/kg
};

/// kLanes packed particles that neither a link nor a bending element joins, and where their links
/// are: slots [first_slot, end_slot), each of one link of every lane. A lane without a particle has
/// one of the spare ones of Layout::packed.
struct VertexGroup {
  PackedSlot particle[kLanes];
  std::uint32_t first_slot, end_slot;
};
/// One link of each lane. A lane without one has one to itself, of no length: it does nothing.
template <class Real>
struct SpringSlot {
  PackedSlot other[kLanes];  ///< end of the link
  Real rest[kLanes];         ///< m
  Real stiffness[kLanes];    ///< N/m
};
/// Of an augmented Lagrangian (avbd.cpp). Both ends of a link keep its numbers and compute the same
/// bits of them: nothing has to be carried from one to the other.
template <class Real>
struct AugmentedSlot : SpringSlot<Real> {
  Real multiplier[kLanes];  ///< N
  Real left[kLanes];        ///< m, alpha C_0
};

/// Of alternating directions (admm.cpp). Both ends of a link keep its multiplier, each as it sees
/// it.
template <class Real>
struct MultiplierSlot : SpringSlot<Real> {
  Real multiplier[3][kLanes];  ///< m, u
  Real share[kLanes];          ///< 1/(1 + k/K)
};

/// What a sweep over vertices reads, and x, which it moves. Arrays of numbers are packed.
template <class Real>
struct VertexSweep {
  const VertexGroup* groups;
  Real* x;
  const Real* y;         ///< where they would go without links
  const Real* previous;  ///< x_t
  const Real* inertia;   ///< [groups][kLanes] m/h^2 [N/m]
  const Real* bending;   ///< [groups][4][kLanes] force x, y, z [N], Hessian [N/m]; null: none
  Real damping;          ///< k_d/h of springs
};
template <class Real>
struct AugmentedStep {
  const VertexGroup* groups;
  AugmentedSlot<Real>* slots;
  const Real *x, *previous;
  Real alpha, beta, gamma, k_min, k_max;  ///< avbd.cpp
};

/// What forces on vertices are computed from. Arrays of numbers are packed.
template <class Real>
struct ForceSweep {
  const VertexGroup* groups;
  const Real *x, *y;    ///< m; y: where they would go without links
  const Real* inertia;  ///< [groups][kLanes] m/h^2 [N/m]
  double* rows;         ///< N, become the forces
};
template <class Real>
struct AccelerationSweep {
  const VertexGroup* groups;
  const Real *x, *previous;
  const Real* w;  ///< [groups][kLanes] 1/kg
  Real* a;        ///< accelerations are added
  Real drag;      ///< N/m, of the way since the step before
};

/// Columns of a sparse factor that are stored as a dense matrix (panel_factor.hpp).
struct FactorPanel {
  std::uint32_t first, columns;   ///< unknowns
  std::uint32_t first_row, rows;  ///< where the numbers of the rows below begin, and how many
  std::size_t first_value;
};
/// Columns of single numbers of a panel at most.
inline constexpr std::uint32_t kWidestPanel = 4;
struct PanelSolve {
  const FactorPanel* panels;
  std::size_t count;
  const std::uint32_t* row;
  const double* values;
};

/// All particles: of an interleaved sheet, or, with one lane, packed ones.
template <class Real>
struct ParticleSpan {
  Real* x;
  const Real* previous;
  SheetRows sheet;
  std::size_t particles;

  /// What can be computed with by itself: rows of a sheet, or kLanes packed particles each.
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
/// Puts out of the collider what is inside, or, continuous, has passed through it in this step; of
/// the parts [begin, end).
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

/// One tether of each particle, in the particles' layout: its pin and, where their x are, its
/// length [m]; kNoTether: none.
template <class Real>
struct TetherTable {
  const Real *pin, *length;
};
/// Longer than any [m]; a float holds its square.
inline constexpr double kNoTether = 1e18;

/// Between which bounds the motions of all particles lie [m].
template <class Real>
struct MotionBox {
  Vec3T<Real> least, most;
};
template <class Real>
struct MotionBoxes {
  MotionBox<Real> since_previous, since_then;
};

/// A search looks at up to so many particles at once.
inline constexpr std::uint32_t kSearchLanes = 8;

/// As many particles from the first on as there are lanes, a bit for each that counts.
struct SearchBlock {
  std::uint32_t first, mask;
};
/// Two particles that may touch in this step.
struct CandidatePair {
  std::uint32_t a, b;
};

/// Particles sorted by the cells of a grid (contact/neighbour_grid.hpp), and what is looked for.
template <class Real>
struct NeighbourSearch {
  /// [particles + kSearchLanes] where each is, how far it has moved in the step, and where it is at
  /// rest: x, y, z [m].
  const Real *now[3], *moved[3], *rest[3];
  const std::uint32_t* buckets;           ///< [particles] where the cell of each is
  const std::uint32_t* starts;            ///< [bucket_count + 1] first particle of each bucket
  std::uint32_t particles, bucket_count;  ///< the latter a power of two
  std::uint32_t row, layer;               ///< buckets from a cell to the next in y and in z
  Real within, ignored;                   ///< m
  bool moving;                            ///< false: none has moved, and `moved` is not read
  SearchBlock* blocks;                    ///< scratch: [particles + 10]
  CandidatePair* found;                   ///< [room]; enough for one: particles + 11 kSearchLanes
  std::size_t room;
};
/// Finds the pairs that are less than `within` and their own way in the step apart and at rest are
/// not less than `ignored` apart; how many. Goes on from particle `next`, which it moves on, until
/// it is at `end` or might find more than there is room for.
template <class Real>
using FindPairs = std::size_t (*)(const NeighbourSearch<Real>&, std::uint32_t& next,
                                  std::uint32_t end);

/// The loops that matter, once for each instruction set.
template <class Real>
struct Kernels {
  /// As wide as the sweep: a few 512-bit instructions in each step slow down the shorter ones of
  /// all its sweeps (a sheet of 32 x 32 by a sixth, batches by 4 %).
  void (*narrow_verlet)(const VerletStep<Real>&, std::size_t begin, std::size_t end);
  void (*wide_verlet)(const VerletStep<Real>&, std::size_t begin, std::size_t end);
  /// Rows [begin, end) of a sweep; by Projection, with kNarrow and with kWide lanes.
  void (*narrow_sheet[2])(const SheetSweep<Real>&, Real* x, int begin, int end);
  void (*wide_sheet[2])(const SheetSweep<Real>&, Real* x, int begin, int end);
  void (*batches[2])(const BatchRun<Real>&, Real* x);
  /// The same with links that may comply, rigid ones exactly. keep: 1; or 0, multipliers begin at
  /// 0.
  void (*compliant_narrow_sheet)(const SheetSweep<Real>&, Real* x, Real keep, int begin, int end);
  void (*compliant_wide_sheet)(const SheetSweep<Real>&, Real* x, Real keep, int begin, int end);
  void (*compliant_batches)(const BatchRun<Real>&, Real* x, Real keep);
  CollideKernels<Real> collide;
  /// Rows [begin, end) of quads; they touch one row of particles more.
  void (*narrow_wind)(const WindStep<Real>&, const SheetFaces<Real>&, int begin, int end);
  void (*wide_wind)(const WindStep<Real>&, const SheetFaces<Real>&, int begin, int end);
  void (*wind_on_faces)(const WindStep<Real>&, std::span<const FaceBatch<Real>>);
  /// Moves the vertices of groups [begin, end), which are of one colour, each to its minimum.
  void (*sweep_springs)(const VertexSweep<Real>&, const SpringSlot<Real>*, std::size_t begin,
                        std::size_t end);
  void (*sweep_augmented)(const VertexSweep<Real>&, const AugmentedSlot<Real>*, std::size_t begin,
                          std::size_t end);
  /// Multipliers and stiffnesses of groups [begin, end), at a substep's start and after a sweep.
  void (*begin_augmented)(const AugmentedStep<Real>&, std::size_t begin, std::size_t end);
  void (*augment)(const AugmentedStep<Real>&, std::size_t begin, std::size_t end);
  /// Of groups [begin, end): rows = links + inertia (y - x).
  void (*spring_forces)(const ForceSweep<Real>&, SpringSlot<Real>*, std::size_t begin,
                        std::size_t end);
  void (*multiplier_forces)(const ForceSweep<Real>&, MultiplierSlot<Real>*, std::size_t begin,
                            std::size_t end);
  /// Of groups [begin, end).
  void (*accelerate)(const AccelerationSweep<Real>&, SpringSlot<Real>*, std::size_t begin,
                     std::size_t end);
  /// A panel of `columns`, with so many rows below, becomes its factor, and `update` [side][side],
  /// its lower triangle, loses what that takes from the rows below; false: a pivot is not positive.
  /// scratch: [2][columns][side]; side: a multiple of 8.
  bool (*eliminate)(double* panel, std::size_t columns, std::size_t rows, double* update,
                    std::size_t side, double* scratch);
  /// [unknowns][4] right-hand sides become solutions.
  void (*solve_panels)(const PanelSolve&, double* rows);
  /// Pulls particles that are farther than their length from their pin to it, table after table; by
  /// Projection.
  void (*tethers[2])(const ParticleSpan<Real>&, std::span<const TetherTable<Real>>);
  /// Of the parts [begin, end), and of the first particle, since the span's `previous` and since
  /// they were at `then`, laid out alike.
  MotionBoxes<Real> (*motion_boxes)(const ParticleSpan<Real>&, const Real* then, std::size_t begin,
                                    std::size_t end);
  /// Square of the largest motion against `middle` of the parts [begin, end) [m^2].
  Real (*largest_motion2)(const ParticleSpan<Real>&, const Vec3T<Real>& middle, std::size_t begin,
                          std::size_t end);
  FindPairs<Real> find_pairs;
  /// Projects independent pairs without loading or storing anything: what the arithmetic alone
  /// costs, for benchmarks. Says how many projections that were.
  Real (*in_registers)(Real rest, int rounds, int& projections);
  /// Loads and stores what batches do and hardly computes: what moving the particles alone costs.
  void (*load_and_store)(const BatchRun<Real>&, Real* x);
};

enum class Simd { scalar, sse2, avx2, avx512 };
std::string_view to_string(Simd);

/// Whether this program was built for it and this machine has it.
bool available(Simd);
/// The widest that is available.
Simd widest();

/// Precondition: available. All of them compute the same bits.
template <class Real>
const Kernels<Real>& kernels(Simd);

/// What instruction_set.cpp makes for each.
template <Simd, class Real>
const Kernels<Real>& kernels_for();

}  // namespace taut
