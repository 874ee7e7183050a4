// synth/simulate/solver/projection.cc
#include "synth/simulate/solver/projection.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace freshet::synth::simulate {
namespace {

constexpr int kSmoothings = 2;  // sweeps before and after, a level
constexpr int kCoarsestSmoothings = 16;
constexpr int kCoarsestSide = 4;

/// One level of the hierarchy. Cell grids carry a rim one cell wide that stays 0, so that sweeps need no
/// branches.
struct Level {
  int width, height;
  Grid face_x, face_y;
  Grid inverse_diagonal;  // 0 in cells without a passable face
  Grid pressure, rhs, residual;

  Level(int w, int h)
      : width(w),
        height(h),
        face_x(w + 1, h),
        face_y(w, h + 1),
        inverse_diagonal(w + 2, h + 2),
        pressure(inverse_diagonal),
        rhs(inverse_diagonal),
        residual(inverse_diagonal) {}

  /// After the faces.
  void set_diagonal() {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const float sum = face_x(x, y) + face_x(x + 1, y) + face_y(x, y) + face_y(x, y + 1);
        inverse_diagonal(x + 1, y + 1) = sum > 0.0f ? 1.0f / sum : 0.0f;
      }
    }
  }
};

/// Rows on threads only where a row is worth it; coarse levels run on the caller.
template <typename Body>
void for_level_rows(const Level& level, const Body& body) {
  if (level.width * level.height > 8192) {
    for_rows(level.height, body);
  } else {
    for (int y = 0; y < level.height; ++y) body(y);
  }
}

void smooth(Level& level, int colour) {
  for_level_rows(level, [&](int y) {
    const std::ptrdiff_t stride = level.width + 2;
    float* p = level.pressure.row(y + 1) + 1;
    const float *b = level.rhs.row(y + 1) + 1, *inverse = level.inverse_diagonal.row(y + 1) + 1;
    const float *fx = level.face_x.row(y), *up = level.face_y.row(y), *down = level.face_y.row(y + 1);
    for (int x = (y + colour) & 1; x < level.width; x += 2) {
      p[x] =
          (b[x] + fx[x] * p[x - 1] + fx[x + 1] * p[x + 1] + up[x] * p[x - stride] + down[x] * p[x + stride]) *
          inverse[x];
    }
  });
}

/// out = A in, where A is the negative Laplacian.
void apply_laplacian(const Level& level, const Grid& in, Grid& out) {
  for_level_rows(level, [&](int y) {
    const std::ptrdiff_t stride = level.width + 2;
    const float* p = in.row(y + 1) + 1;
    const float *fx = level.face_x.row(y), *up = level.face_y.row(y), *down = level.face_y.row(y + 1);
    float* q = out.row(y + 1) + 1;
    for (int x = 0; x < level.width; ++x) {
      q[x] = fx[x] * (p[x] - p[x - 1]) + fx[x + 1] * (p[x] - p[x + 1]) + up[x] * (p[x] - p[x - stride]) +
             down[x] * (p[x] - p[x + stride]);
    }
  });
}

void coarsen(const Level& fine, Level& coarse) {
  const int width = coarse.width, height = coarse.height;
  Grid &fx = coarse.face_x, &fy = coarse.face_y;
  // A coarse face is twice as long and its cells lie twice as far apart: the mean of the two fine faces.
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x <= width; ++x) {
      const int from = std::min(2 * x, fine.width);
      const float second = 2 * y + 1 < fine.height ? fine.face_x(from, 2 * y + 1) : 0.0f;
      fx(x, y) = 0.5f * (fine.face_x(from, 2 * y) + second);
    }
  }
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int from = std::min(2 * y, fine.height);
      const float second = 2 * x + 1 < fine.width ? fine.face_y(2 * x + 1, from) : 0.0f;
      fy(x, y) = 0.5f * (fine.face_y(2 * x, from) + second);
    }
  }
  coarse.set_diagonal();
}

void restrict_residual(Level& fine, Level& coarse) {
  apply_laplacian(fine, fine.pressure, fine.residual);
  for_level_rows(coarse, [&](int y) {
    float* out = coarse.rhs.row(y + 1) + 1;
    for (int x = 0; x < coarse.width; ++x) {
      float sum = 0.0f;  // the rim of rhs and of residual is 0: no test for odd sizes
      for (int dy = 1; dy <= 2; ++dy) {
        for (int dx = 1; dx <= 2; ++dx) {
          const int fx = 2 * x + dx, fy = 2 * y + dy;
          if (fx > fine.width || fy > fine.height) continue;
          sum += fine.rhs(fx, fy) - fine.residual(fx, fy);
        }
      }
      out[x] = coarse.inverse_diagonal(x + 1, y + 1) > 0.0f ? sum : 0.0f;
    }
  });
}

void prolong(const Level& coarse, Level& fine) {
  for_level_rows(fine, [&](int y) {
    float* p = fine.pressure.row(y + 1) + 1;
    const float* inverse = fine.inverse_diagonal.row(y + 1) + 1;
    const float* q = coarse.pressure.row(y / 2 + 1) + 1;
    for (int x = 0; x < fine.width; ++x) {
      if (inverse[x] > 0.0f) p[x] += q[x / 2];
    }
  });
}

void v_cycle(std::vector<Level>& levels, std::size_t at) {
  Level& level = levels[at];
  std::fill(level.pressure.values.begin(), level.pressure.values.end(), 0.0f);
  const bool coarsest = at + 1 == levels.size();
  const int sweeps = coarsest ? kCoarsestSmoothings : kSmoothings;
  for (int i = 0; i < sweeps; ++i) smooth(level, 0), smooth(level, 1);
  if (!coarsest) {
    restrict_residual(level, levels[at + 1]);
    v_cycle(levels, at + 1);
    prolong(levels[at + 1], level);
  }
  for (int i = 0; i < sweeps; ++i) smooth(level, 1), smooth(level, 0);
}

}  // namespace

struct Projection::Impl {
  std::vector<Level> levels;
  Grid pressure, direction, product, residual;
  std::vector<double> row_sums;
  int fluid_cells = 0;
  bool open = false;  // a face leads to open air; otherwise pressure is known up to a constant

  double dot(const Grid& a, const Grid& b) {
    const Level& top = levels.front();
    for_level_rows(top, [&](int y) {
      const float *p = a.row(y + 1) + 1, *q = b.row(y + 1) + 1;
      double sum = 0.0;
      for (int x = 0; x < top.width; ++x) sum += static_cast<double>(p[x]) * static_cast<double>(q[x]);
      row_sums[static_cast<std::size_t>(y)] = sum;
    });
    double total = 0.0;
    for (const double sum : row_sums) total += sum;
    return total;
  }

  /// a += scale * b
  void add(Grid& a, float scale, const Grid& b) {
    for_level_rows(levels.front(), [&](int y) {
      float* p = a.row(y + 1);
      const float* q = b.row(y + 1);
      for (int x = 0; x < a.width; ++x) p[x] += scale * q[x];
    });
  }

  void remove_mean(Grid& a) {
    const Level& top = levels.front();
    double total = 0.0;
    for (int y = 1; y <= top.height; ++y) {
      double sum = 0.0;
      for (int x = 1; x <= top.width; ++x) sum += static_cast<double>(a(x, y));
      total += sum;
    }
    const float mean = static_cast<float>(total / std::max(1, fluid_cells));
    for (int y = 1; y <= top.height; ++y) {
      for (int x = 1; x <= top.width; ++x) {
        if (top.inverse_diagonal(x, y) > 0.0f) a(x, y) -= mean;
      }
    }
  }

  const Grid& precondition(const Grid& r) {
    levels.front().rhs.values = r.values;  // same size: no allocation
    v_cycle(levels, 0);
    return levels.front().pressure;
  }
};

Projection::Projection(const Grid& face_x, const Grid& face_y) : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.levels.emplace_back(face_y.width, face_x.height);
  while (std::min(m.levels.back().width, m.levels.back().height) > kCoarsestSide)
    m.levels.emplace_back((m.levels.back().width + 1) / 2, (m.levels.back().height + 1) / 2);
  const Level& top = m.levels.front();
  m.pressure = m.direction = m.product = m.residual = Grid(top.width + 2, top.height + 2);
  m.row_sums.resize(static_cast<std::size_t>(top.height));
  reset(face_x, face_y);
}

void Projection::reset(const Grid& face_x, const Grid& face_y) {
  Impl& m = *impl_;
  Level& top = m.levels.front();
  top.face_x.values = face_x.values, top.face_y.values = face_y.values;  // same size: no allocation
  top.set_diagonal();
  for (std::size_t i = 1; i < m.levels.size(); ++i) coarsen(m.levels[i - 1], m.levels[i]);
  m.fluid_cells = 0, m.open = false;
  for (int y = 1; y <= top.height; ++y) {
    for (int x = 1; x <= top.width; ++x) {
      const bool fluid = top.inverse_diagonal(x, y) > 0.0f;
      m.fluid_cells += fluid;
      if (!fluid) m.pressure(x, y) = 0.0f;
    }
  }
  for (int y = 0; y < top.height; ++y) m.open |= face_x(0, y) > 0.0f || face_x(top.width, y) > 0.0f;
  for (int x = 0; x < top.width; ++x) m.open |= face_y(x, 0) > 0.0f || face_y(x, top.height) > 0.0f;
}
Projection::Projection(Projection&&) noexcept = default;
Projection::~Projection() = default;

ProjectionReport Projection::apply(Grid& u, Grid& v, const ProjectionOptions& options, const Grid* source) {
  Impl& m = *impl_;
  Level& top = m.levels.front();
  const double cells = std::max(1, m.fluid_cells);

  // Residual of the first guess: b - A p, b the negative divergence.
  for_level_rows(top, [&](int y) {
    float* r = m.residual.row(y + 1) + 1;
    for (int x = 0; x < top.width; ++x) {
      const float asked = source != nullptr ? (*source)(x, y) : 0.0f;
      const float out = u(x + 1, y) - u(x, y) + v(x, y + 1) - v(x, y) - asked;
      r[x] = top.inverse_diagonal(x + 1, y + 1) > 0.0f ? -out : 0.0f;
    }
  });
  ProjectionReport report;
  report.divergence_before = std::sqrt(m.dot(m.residual, m.residual) / cells);
  if (!m.open) m.remove_mean(m.residual);
  const double plain = m.dot(m.residual, m.residual);
  apply_laplacian(top, m.pressure, m.product);
  m.add(m.residual, -1.0f, m.product);
  double square = m.dot(m.residual, m.residual);
  if (!(square < plain)) {  // the old pressure is worse than none, or not a number
    std::fill(m.pressure.values.begin(), m.pressure.values.end(), 0.0f);
    m.add(m.residual, 1.0f, m.product);
    square = m.dot(m.residual, m.residual);
  }

  const double target = options.max_divergence * options.max_divergence * cells;
  double old_rz = 0.0;
  while (square > target && report.iterations < options.max_iterations) {
    const Grid& z = m.precondition(m.residual);
    const double rz = m.dot(m.residual, z);
    if (!(rz > 0.0)) break;
    const float beta = report.iterations == 0 ? 0.0f : static_cast<float>(rz / old_rz);
    for_level_rows(top, [&](int y) {
      float* d = m.direction.row(y + 1);
      const float* q = z.row(y + 1);
      for (int x = 0; x < m.direction.width; ++x) d[x] = q[x] + (report.iterations == 0 ? 0.0f : beta * d[x]);
    });
    apply_laplacian(top, m.direction, m.product);
    const double curvature = m.dot(m.direction, m.product);
    if (!(curvature > 0.0)) break;
    const float step = static_cast<float>(rz / curvature);
    m.add(m.pressure, step, m.direction);
    m.add(m.residual, -step, m.product);
    square = m.dot(m.residual, m.residual);
    old_rz = rz;
    ++report.iterations;
  }

  for_level_rows(top, [&](int y) {
    const float *p = m.pressure.row(y + 1) + 1, *above = m.pressure.row(y) + 1;
    const float *fx = top.face_x.row(y), *fy = top.face_y.row(y);
    float *pu = u.row(y), *pv = v.row(y);
    for (int x = 0; x <= top.width; ++x) pu[x] -= fx[x] * (p[x] - p[x - 1]);
    for (int x = 0; x < top.width; ++x) pv[x] -= fy[x] * (p[x] - above[x]);
  });
  {
    const float* last = m.pressure.row(top.height) + 1;
    const float* fy = top.face_y.row(top.height);
    float* pv = v.row(top.height);
    for (int x = 0; x < top.width; ++x) pv[x] -= fy[x] * (0.0f - last[x]);
  }
  report.divergence_after = divergence(u, v, top.face_x, top.face_y, source);
  return report;
}

double divergence(const Grid& u, const Grid& v, const Grid& face_x, const Grid& face_y, const Grid* source) {
  double total = 0.0;
  int cells = 0;
  for (int y = 0; y < face_x.height; ++y) {
    double sum = 0.0;
    for (int x = 0; x < face_y.width; ++x) {
      if (face_x(x, y) + face_x(x + 1, y) + face_y(x, y) + face_y(x, y + 1) <= 0.0f) continue;
      const float asked = source != nullptr ? (*source)(x, y) : 0.0f;
      const float out = u(x + 1, y) - u(x, y) + v(x, y + 1) - v(x, y) - asked;
      sum += static_cast<double>(out) * static_cast<double>(out);
      ++cells;
    }
    total += sum;
  }
  return std::sqrt(total / std::max(1, cells));
}

}  // namespace freshet::synth::simulate
