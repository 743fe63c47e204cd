#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/bases/check_range.h>

namespace fascia {
namespace {

// The dense eigenproblem takes about (nodes / 1000)³ seconds: enough for weights this smooth.
constexpr int kMaxNodes = 1200;

// Cells of the body and a number for each of their corners.
class CellGrid {
 public:
  CellGrid(int dimension, const Box& domain, double cell_m,
           const std::function<bool(const Vec3&)>& inside)
      : dimension_(dimension), low_(domain.low), cell_m_(cell_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double cells = axis < dimension ? std::ceil(domain.size()[axis] / cell_m - 1e-9) : 0;
      count_[axis] = static_cast<int>(std::clamp(cells, 1.0, 1e3));
    }
    if (dimension == 2) count_.z() = 1, low_.z() = 0;
    node_.assign(static_cast<std::size_t>((count_.array() + 1).prod()), -1);
    for (int k = 0; k < count_.z(); ++k)
      for (int j = 0; j < count_.y(); ++j)
        for (int i = 0; i < count_.x(); ++i) addIfInside({i, j, k}, inside);
  }

  int nodeCount() const { return nodeCount_; }
  int cornerCount() const { return 1 << dimension_; }
  double cell_m() const { return cell_m_; }
  const std::vector<Eigen::Vector3i>& cells() const { return cells_; }

  int node(const Eigen::Vector3i& cell, int corner) const {
    return node_[index(cell + cornerOffset(corner))];
  }

  // The body's cell around X, or the one nearest to it, and the place of X in units of it.
  Eigen::Vector3i cellAt(const Vec3& X, Vec3& u) const {
    const Vec3 x = (X - low_) / cell_m_;
    const auto distance = [&](const Eigen::Vector3i& c) {
      double farthest = 0;
      for (int axis = 0; axis < dimension_; ++axis)
        farthest = std::max(farthest, std::abs(x[axis] - c[axis] - 0.5));
      return farthest;
    };
    const Eigen::Vector3i nearest = *std::ranges::min_element(cells_, {}, distance);
    u = x - nearest.cast<double>();
    if (dimension_ == 2) u.z() = 0;
    return nearest;
  }

  static Eigen::Vector3i cornerOffset(int corner) {
    return {corner & 1, (corner >> 1) & 1, (corner >> 2) & 1};
  }

 private:
  std::size_t index(const Eigen::Vector3i& n) const {
    return static_cast<std::size_t>((n.z() * (count_.y() + 1) + n.y()) * (count_.x() + 1) + n.x());
  }
  void addIfInside(const Eigen::Vector3i& cell, const std::function<bool(const Vec3&)>& inside) {
    Vec3 center = low_ + cell_m_ * (cell.cast<double>() + Vec3::Constant(0.5));
    if (dimension_ == 2) center.z() = 0;
    if (!inside(center)) return;
    cells_.push_back(cell);
    for (int corner = 0; corner < cornerCount(); ++corner) {
      int& n = node_[index(cell + cornerOffset(corner))];
      if (n < 0) n = nodeCount_++;
    }
  }

  int dimension_;
  Vec3 low_;
  double cell_m_;
  Eigen::Vector3i count_;
  std::vector<Eigen::Vector3i> cells_;
  std::vector<int> node_;
  int nodeCount_ = 0;
};

// A corner's multilinear function at u in [0, 1]^d, and its gradient by u.
double cornerWeight(int corner, int dimension, const Vec3& u, Vec3& gradient) {
  double factor[3] = {1, 1, 1};
  double sign[3] = {0, 0, 0};
  for (int axis = 0; axis < dimension; ++axis) {
    const bool upper = (corner >> axis) & 1;
    factor[axis] = upper ? u[axis] : 1 - u[axis];
    sign[axis] = upper ? 1 : -1;
  }
  gradient = Vec3(sign[0] * factor[1] * factor[2], sign[1] * factor[0] * factor[2],
                  sign[2] * factor[0] * factor[1]);
  return factor[0] * factor[1] * factor[2];
}

// Columns: the lowest solutions of L w = μ M w, L the Laplacian's stiffness matrix by multilinear
// elements with 2-point Gauss integrals, M the lumped mass.
Eigen::MatrixXd lowestModes(const CellGrid& grid, int dimension, int modes) {
  const int n = grid.nodeCount(), corners = grid.cornerCount();
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n), element(corners, corners);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
  element.setZero();
  const double gauss[2] = {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)};
  for (int q = 0; q < corners; ++q) {
    const Vec3 u(gauss[q & 1], gauss[(q >> 1) & 1], gauss[(q >> 2) & 1]);
    Eigen::MatrixXd slopes(3, corners);
    for (int c = 0; c < corners; ++c) {
      Vec3 gradient;
      cornerWeight(c, dimension, u, gradient);
      slopes.col(c) = gradient;
    }
    element += slopes.transpose() * slopes / corners;
  }
  for (const Eigen::Vector3i& cell : grid.cells()) {
    for (int a = 0; a < corners; ++a) {
      mass[grid.node(cell, a)] += 1.0 / corners;
      for (int b = 0; b < corners; ++b)
        stiffness(grid.node(cell, a), grid.node(cell, b)) += element(a, b);
    }
  }
  const Eigen::VectorXd root = mass.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(root.asDiagonal() * stiffness *
                                                              root.asDiagonal());
  Eigen::MatrixXd w = root.asDiagonal() * solver.eigenvectors().leftCols(modes);
  // The lowest mode is constant: exactly so, that rest and rigid motion are represented exactly.
  w.col(0).setOnes();
  for (int j = 1; j < modes; ++j) w.col(j) /= w.col(j).cwiseAbs().maxCoeff();
  return w;
}

class SkinningModesBasis final : public Basis {
 public:
  SkinningModesBasis(int dimension, int modes, CellGrid grid)
      : dimension_(dimension), modes_(modes), grid_(std::move(grid)) {
    weights_ = lowestModes(grid_, dimension, modes);
  }
  std::string_view name() const override { return "skinning-modes"; }
  int dimension() const override { return dimension_; }
  int size() const override { return modes_ * (dimension_ + 1); }
  // Along an axis there are about two functions for each mode: as many as of polynomials of this
  // degree, which so tells them apart.
  int degree() const override { return std::max(dimension_, 2 * modes_ - 1); }
  Degrees slopeDegrees() const override { return {Eigen::Vector3i::Zero(), 0}; }

  void values(const Vec3& X, Eigen::Ref<Eigen::VectorXd> p) const override {
    const Weights w = weightsAt(X);
    for (int j = 0; j < modes_; ++j) {
      for (int axis = 0; axis < dimension_; ++axis)
        p[j * (dimension_ + 1) + axis] = w.value[j] * X[axis];
      p[j * (dimension_ + 1) + dimension_] = w.value[j];
    }
  }
  void gradients(const Vec3& X, Eigen::Ref<Eigen::MatrixXd> dp) const override {
    const Weights w = weightsAt(X);
    dp.setZero();
    for (int j = 0; j < modes_; ++j) {
      const int first = j * (dimension_ + 1);
      for (int axis = 0; axis < dimension_; ++axis) {
        dp.row(first + axis) = X[axis] * w.slope.row(j);
        dp(first + axis, axis) += w.value[j];
      }
      dp.row(first + dimension_) = w.slope.row(j);
    }
  }

 private:
  struct Weights {
    Eigen::VectorXd value;  // modes
    Eigen::MatrixXd slope;  // modes x 3, 1/m
  };
  Weights weightsAt(const Vec3& X) const {
    Weights w{Eigen::VectorXd::Zero(modes_), Eigen::MatrixXd::Zero(modes_, 3)};
    Vec3 u, gradient;
    const Eigen::Vector3i cell = grid_.cellAt(X, u);
    for (int corner = 0; corner < grid_.cornerCount(); ++corner) {
      const double share = cornerWeight(corner, dimension_, u, gradient);
      const auto nodal = weights_.row(grid_.node(cell, corner)).transpose();
      w.value += share * nodal;
      w.slope += nodal * gradient.transpose() / grid_.cell_m();
    }
    return w;
  }

  int dimension_, modes_;
  CellGrid grid_;
  Eigen::MatrixXd weights_;  // nodes x modes
};

}  // namespace

BasisPtr makeSkinningModesBasis(int dimension, int modes, const Box& domain, double cell_m,
                                const std::function<bool(const Vec3&)>& inside) {
  checkRange("basis", "dimension", dimension, 2, 3);
  checkRange("basis", "cell_m", cell_m, 1e-9, 1e9);
  CellGrid grid(dimension, domain, cell_m, inside);
  checkRange("basis", "nodes of the body's cells", grid.nodeCount(), 1, kMaxNodes);
  checkRange("basis", "modes", modes, 1, grid.nodeCount());
  return std::make_shared<SkinningModesBasis>(dimension, modes, std::move(grid));
}

}  // namespace fascia
