#include "core/solver/wind.hpp"

#include <algorithm>

#include "core/model/index.hpp"
#include "core/solver/layout/interleaved_sheet.hpp"

namespace taut {

namespace {

/// The common base of all passes of wind.
template <class Real>
class WindPass : public Pass<Real> {
 public:
  explicit WindPass(const Wind& wind) : wind_(wind) {}

 protected:
  WindStep<Real> step(Particles<Real>& p, double dt) const {
    const Vec3& v = wind_.velocity;
    const bool relative = wind_.law == Wind::Law::relative;
    return {p.x.data(),
            p.previous.data(),
            p.a.data(),
            {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())},
            static_cast<Real>(relative ? 1 / (3 * dt) : 0),
            static_cast<Real>(wind_.strength / 6)};
  }

 private:
  Wind wind_;
};

/// Wind on the faces of a regular sheet, a vector of quads at a time.
template <class Real>
class SheetWindPass final : public WindPass<Real> {
 public:
  SheetWindPass(const Scene& scene, std::span<const double> w, const Layout& layout, Simd simd,
                ThreadPool& pool)
      : WindPass<Real>(*scene.wind), items_(scene.mesh.triangles.size()), pool_(pool) {
    const auto [rows, columns, lanes, vectors, stride] = layout.sheet();
    kernel_ = lanes == kWide ? kernels<Real>(simd).wide_wind : kernels<Real>(simd).narrow_wind;
    quad_rows_ = rows - 1;
    const std::size_t row = to_index(lanes * vectors);
    w_.resize(to_index(rows) * row);
    diagonals_.resize(2 * row);
    const std::size_t lane_count = to_index(lanes);
    for (std::size_t v = 0; v < w.size(); ++v) {
      const std::size_t in_row = layout.slot(v) % stride;
      w_[layout.slot(v) / stride * row + in_row / (3 * lane_count) * lane_count +
         in_row % lane_count] = static_cast<Real>(w[v]);
    }
    for (int i = 0; i + 1 < columns; ++i)
      for (int j = 0; j < 2; ++j)  // split as by make_sheet
        diagonals_[to_index(j) * row + to_index(i % vectors * lanes + i / vectors)] =
            (i + j) % 2 == 0 ? Real(1) : Real(-1);
    faces_ = {vectors, stride, {diagonals_.data(), diagonals_.data() + row}, w_.data()};
  }

  void apply(Particles<Real>& p, double, double dt) override {
    const WindStep<Real> step = this->step(p, dt);
    pool_.queue_pairs(
        p.layout->blocks(),
        [this, step](std::size_t block) {
          const auto [begin, end] = rows_of_block(block, quad_rows_);
          kernel_(step, faces_, begin, end);
        },
        p.size() >= ThreadPool::kWorthSharing);
  }
  bool queues() const override { return true; }

  std::vector<PassCost> cost() const override {
    return {
        {.pass = "wind", .items = items_, .bytes = (w_.size() + diagonals_.size()) * sizeof(Real)}};
  }

 private:
  std::size_t items_;
  ThreadPool& pool_;
  void (*kernel_)(const WindStep<Real>&, const SheetFaces<Real>&, int, int);
  int quad_rows_ = 0;
  std::vector<Real> w_, diagonals_;
  SheetFaces<Real> faces_{};
};

/// Wind on any faces of packed particles.
template <class Real>
class FaceWindPass final : public WindPass<Real> {
 public:
  FaceWindPass(const Scene& scene, std::span<const double> w, const Layout& layout, Simd simd)
      : WindPass<Real>(*scene.wind),
        items_(scene.mesh.triangles.size()),
        kernel_(kernels<Real>(simd).wind_on_faces) {
    batches_.reserve((items_ + kLanes - 1) / kLanes);
    for (std::size_t f = 0; f < items_; ++f) {
      if (f % kLanes == 0) add_idle_batch(layout);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t i = to_index(scene.mesh.triangles[f][c]);
        batches_.back().corner[c][f % kLanes] = static_cast<std::uint32_t>(layout.slot(i) / 4);
        batches_.back().w[c][f % kLanes] = static_cast<Real>(w[i]);
      }
    }
  }

  void apply(Particles<Real>& p, double, double dt) override {
    kernel_(this->step(p, dt), batches_);
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "wind", .items = items_, .bytes = batches_.size() * sizeof batches_[0]}};
  }

 private:
  /// Adds a batch of faces between a spare particle and itself, which do nothing.
  void add_idle_batch(const Layout& layout) {
    FaceBatch<Real>& batch = batches_.emplace_back();
    for (auto& corners : batch.corner)
      std::ranges::fill(corners, static_cast<std::uint32_t>(layout.size()));
  }

  std::size_t items_;
  void (*kernel_)(const WindStep<Real>&, std::span<const FaceBatch<Real>>);
  std::vector<FaceBatch<Real>> batches_;
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_wind(const Scene& scene, std::span<const double> w,
                                      const Layout& layout, Simd simd, ThreadPool& pool) {
  if (layout.sheet().lanes > 1)
    return std::make_unique<SheetWindPass<Real>>(scene, w, layout, simd, pool);
  return std::make_unique<FaceWindPass<Real>>(scene, w, layout, simd);
}

template std::unique_ptr<Pass<float>> make_wind(const Scene&, std::span<const double>,
                                                const Layout&, Simd, ThreadPool&);
template std::unique_ptr<Pass<double>> make_wind(const Scene&, std::span<const double>,
                                                 const Layout&, Simd, ThreadPool&);

}  // namespace taut
