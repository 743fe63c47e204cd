#include <fascia/math/supernodal_cholesky.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include <Eigen/Core>

#include <fascia/base/assert.h>
#include <fascia/base/index.h>
#include <fascia/base/parallel.h>
#include <fascia/math/cholesky/multifrontal.h>
#include <fascia/math/cholesky/nested_dissection.h>
#include <fascia/math/cholesky/panel_kernels.h>

namespace fascia {
namespace {

constexpr int floatsPerRow(int sides) {
  return sides == 1 ? 1 : 4;
}

// Writes the panel of a supernode (see PanelView); false if an entry is not finite in float.
bool storePanel(const Eigen::Ref<const Eigen::MatrixXd>& triangle,
                const Eigen::Ref<const Eigen::MatrixXd>& below, std::span<float> values) {
  const Eigen::Index width = triangle.rows(), height = width + below.rows();
  Eigen::MatrixXd stored = Eigen::MatrixXd::Zero(height, width);
  stored.topRows(width).setIdentity();
  triangle.triangularView<Eigen::Lower>().solveInPlace(stored.topRows(width));
  FASCIA_ASSERT(
      values.size() >= cholesky::panelSize(static_cast<int>(width), static_cast<int>(height)),
      "the panel has room");
  stored.bottomRows(below.rows()).noalias() = -below * stored.topRows(width);
  cholesky::packPanel(static_cast<int>(width), static_cast<int>(height), stored.data(),
                      values.data());
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

bool SupernodalCholesky::factorize(const SparseMatrix& a) {
  *this = {};
  FASCIA_ASSERT(a.rows() == a.cols(), "the matrix is square");
  if (a.rows() == 0) return true;
  const cholesky::Graph graph = cholesky::graphOf(a);
  const cholesky::Supernodes supernodes =
      cholesky::findSupernodes(graph, cholesky::nestedDissection(graph));
  const cholesky::Tasks tasks = cholesky::splitIntoTasks(supernodes);
  layOut(supernodes, tasks);
  FASCIA_ASSERT(areBelow(rows_, solutionRows_), "panels name rows of the solution");
  std::atomic<bool> finite = true;
  const cholesky::TakeColumns take = [&](std::size_t s, const auto& triangle, const auto& below) {
    const std::span<float> values(values_.data() + panels_[s].values,
                                  values_.data() + panels_[s].end);
    if (!storePanel(triangle, below, values)) finite = false;
  };
  if (cholesky::factorizeMultifrontal(a, supernodes, tasks, take) && finite) return true;
  *this = {};
  return false;
}

void SupernodalCholesky::layOut(const cholesky::Supernodes& supernodes,
                                const cholesky::Tasks& tasks) {
  order_ = supernodes.order;
  std::size_t values = 0;
  for (const cholesky::Supernode& node : supernodes.nodes) {
    Panel& panel = panels_.emplace_back();
    panel.width = node.width;
    panel.height = node.width + static_cast<int>(node.below.size());
    panel.values = values;
    panel.rows = rows_.size();
    values += cholesky::panelSize(panel.width, panel.height);
    panel.end = values;
    panelMemory_ = std::max(panelMemory_, cholesky::panelMemory(panel.height));
    for (int k = 0; k < node.width; ++k) rows_.push_back(node.first + k);
    rows_.insert(rows_.end(), node.below.begin(), node.below.end());
  }
  values_.resize(values);
  top_ = tasks.top;
  taskStart_ = tasks.start;
  solutionRows_ = order_.size();
  for (const cholesky::Subtree& given : tasks.subtrees) {
    subtrees_.push_back({.first = given.first, .end = given.end});
    layOutSubtree(supernodes, subtrees_.back());
  }
}

void SupernodalCholesky::layOutSubtree(const cholesky::Supernodes& supernodes, Subtree& subtree) {
  const cholesky::Supernode& root = supernodes.nodes[at(subtree.end - 1)];
  subtree.firstColumn = supernodes.nodes[at(subtree.first)].first;
  subtree.endColumn = root.first + root.width;
  subtree.tail = static_cast<int>(solutionRows_);
  subtree.above = above_.size();
  subtree.aboveCount = static_cast<int>(root.below.size());
  above_.insert(above_.end(), root.below.begin(), root.below.end());
  solutionRows_ += root.below.size();
  // All rows that descendants reach above the subtree are rows of its root.
  const Panel& last = panels_[at(subtree.end - 1)];
  const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(last.rows) + last.height;
  for (auto row = rows_.begin() + static_cast<std::ptrdiff_t>(panels_[at(subtree.first)].rows);
       row != end; ++row) {
    if (*row < subtree.endColumn) continue;
    const auto found = std::lower_bound(root.below.begin(), root.below.end(), *row);
    FASCIA_ASSERT(found != root.below.end() && *found == *row,
                  "what descendants reach above is a row of the root");
    *row = subtree.tail + static_cast<int>(found - root.below.begin());
  }
}

cholesky::PanelView SupernodalCholesky::view(int panel) const {
  FASCIA_ASSERT(at(panel) < panels_.size(), "the panel exists");
  const Panel& p = panels_[at(panel)];
  return {values_.data() + p.values, values_.data() + p.end, rows_.data() + p.rows, p.width,
          p.height};
}

namespace {

template <int kSides>
void forward(const cholesky::PanelView& panel, float* x, float* memory) {
  if constexpr (kSides == 1) cholesky::forwardOne(panel, x, memory);
  if constexpr (kSides == 3) cholesky::forwardThree(panel, x, memory);
}
template <int kSides>
void backward(const cholesky::PanelView& panel, float* x, float* memory) {
  if constexpr (kSides == 1) cholesky::backwardOne(panel, x, memory);
  if constexpr (kSides == 3) cholesky::backwardThree(panel, x, memory);
}

// Right sides → the solution's rows [first, end), and back.
template <int kSides>
void load(const std::vector<int>& order, int first, int end, const std::span<float>* sides,
          float* x) {
  constexpr int kFloats = floatsPerRow(kSides);
  for (int k = first; k < end; ++k) {
    float* row = x + kFloats * static_cast<std::ptrdiff_t>(k);
    for (int s = 0; s < kSides; ++s) row[s] = sides[s][at(order[at(k)])];
    if constexpr (kFloats > kSides) row[kSides] = 0;
  }
}
template <int kSides>
void store(const std::vector<int>& order, int first, int end, const float* x,
           const std::span<float>* sides) {
  constexpr int kFloats = floatsPerRow(kSides);
  for (int k = first; k < end; ++k)
    for (int s = 0; s < kSides; ++s)
      sides[s][at(order[at(k)])] = x[kFloats * static_cast<std::ptrdiff_t>(k) + s];
}

}  // namespace

template <int kSides>
void SupernodalCholesky::sweepForward(const Subtree& subtree, const std::span<float>* sides,
                                      float* x, float* memory) const {
  constexpr int kFloats = floatsPerRow(kSides);
  load<kSides>(order_, subtree.firstColumn, subtree.endColumn, sides, x);
  std::fill_n(x + kFloats * static_cast<std::ptrdiff_t>(subtree.tail), kFloats * subtree.aboveCount,
              0.0f);
  for (int p = subtree.first; p < subtree.end; ++p) forward<kSides>(view(p), x, memory);
}

template <int kSides>
void SupernodalCholesky::sweepBackward(const Subtree& subtree, const std::span<float>* sides,
                                       float* x, float* memory) const {
  constexpr int kFloats = floatsPerRow(kSides);
  for (int k = 0; k < subtree.aboveCount; ++k) {
    const int row = above_[subtree.above + at(k)];
    std::copy_n(x + kFloats * static_cast<std::ptrdiff_t>(row), kFloats,
                x + kFloats * static_cast<std::ptrdiff_t>(subtree.tail + k));
  }
  for (int p = subtree.end - 1; p >= subtree.first; --p) backward<kSides>(view(p), x, memory);
  store<kSides>(order_, subtree.firstColumn, subtree.endColumn, x, sides);
}

template <int kSides>
void SupernodalCholesky::sweepTop(const std::span<float>* sides, float* x, float* memory) const {
  constexpr int kFloats = floatsPerRow(kSides);
  const auto columns = [this](int p) {
    const int first = rows_[panels_[at(p)].rows];
    return std::pair(first, first + panels_[at(p)].width);
  };
  for (const int p : top_) load<kSides>(order_, columns(p).first, columns(p).second, sides, x);
  for (const Subtree& subtree : subtrees_)
    for (int k = 0; k < subtree.aboveCount; ++k) {
      const auto row = static_cast<std::ptrdiff_t>(above_[subtree.above + at(k)]);
      for (int i = 0; i < kFloats; ++i)
        x[kFloats * row + i] += x[kFloats * static_cast<std::ptrdiff_t>(subtree.tail + k) + i];
    }
  for (const int p : top_) forward<kSides>(view(p), x, memory);
  for (auto p = top_.rbegin(); p != top_.rend(); ++p) backward<kSides>(view(*p), x, memory);
  for (const int p : top_) store<kSides>(order_, columns(p).first, columns(p).second, x, sides);
}

template <int kSides>
void SupernodalCholesky::solveSides(const std::span<float>* sides, Scratch& scratch) const {
  for (int s = 0; s < kSides; ++s)
    FASCIA_ASSERT(sides[s].size() == size(), "a right side has a number per row");
  if (size() == 0) return;
  const std::size_t tasks = taskStart_.size() - 1;
  const auto grow = [](FloatArray& a, std::size_t n) {
    if (a.size() < n) a.resize(n);
  };
  grow(scratch.solution, floatsPerRow(kSides) * solutionRows_);
  grow(scratch.panel, (tasks + 1) * panelMemory_);
  float* x = scratch.solution.data();
  float* memory = scratch.panel.data();
  parallelFor(tasks, [&](std::size_t t) {
    for (int k = taskStart_[t]; k < taskStart_[t + 1]; ++k)
      sweepForward<kSides>(subtrees_[at(k)], sides, x, memory + t * panelMemory_);
  });
  sweepTop<kSides>(sides, x, memory + tasks * panelMemory_);
  parallelFor(tasks, [&](std::size_t t) {
    for (int k = taskStart_[t + 1] - 1; k >= taskStart_[t]; --k)
      sweepBackward<kSides>(subtrees_[at(k)], sides, x, memory + t * panelMemory_);
  });
}

void SupernodalCholesky::solve(std::span<float> x, Scratch& scratch) const {
  solveSides<1>(&x, scratch);
}

void SupernodalCholesky::solve(std::span<float> x, std::span<float> y, std::span<float> z,
                               Scratch& scratch) const {
  const std::span<float> sides[] = {x, y, z};
  solveSides<3>(sides, scratch);
}

}  // namespace fascia
