// SPDX-License-Identifier: Apache-2.0
#include "analysis/fit/least_squares.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "analysis/fit/least_squares_border.h"
#include "core/failure.h"
#include "core/installation.h"

namespace slew::analysis {
namespace {

std::string path_of_ceres() {
  return sibling_program("libslewring_least_squares.so");
}

MinimiseSquares* open_ceres() {
  // stays loaded to the end of the process
  void* library = ::dlopen(path_of_ceres().c_str(), RTLD_NOW | RTLD_LOCAL);
  auto* minimise =
      library == nullptr ? nullptr : reinterpret_cast<MinimiseSquares*>(::dlsym(library, kMinimiseSquares));
  if (minimise != nullptr) return minimise;
  throw Failure(ExitCode::resources, std::string("the least squares cannot be loaded: ") + ::dlerror() +
                                         "; nothing was run; install libceres-dev and build Slewring again");
}

// The caller's function behind the border; its exceptions wait on this side.
struct Callback {
  const ResidualsAt& residuals_at;
  std::size_t unknowns, residuals;
  bool was_ended = false;
  std::exception_ptr fault{};

  bool call(const double* points, std::size_t count, double* residuals_out, unsigned char* has_value) {
    std::vector<std::vector<double>> each;
    for (std::size_t p = 0; p < count; ++p) each.emplace_back(points + p * unknowns, points + (p + 1) * unknowns);
    const auto values = residuals_at(each);
    was_ended = was_ended || values.empty();
    if (was_ended) return false;
    for (std::size_t p = 0; p < count; ++p) {
      has_value[p] = values[p] ? 1 : 0;
      if (values[p]) std::copy_n(values[p]->begin(), residuals, residuals_out + p * residuals);
    }
    return true;
  }
};

bool call_back(void* context, const double* points, std::size_t count, double* residuals, unsigned char* has_value) {
  auto& callback = *static_cast<Callback*>(context);
  if (callback.was_ended || callback.fault) return false;
  try {
    return callback.call(points, count, residuals, has_value);
  } catch (...) {
    callback.fault = std::current_exception();
    return false;
  }
}

}  // namespace

LeastSquares minimise_squares(std::vector<double> start, std::size_t residuals, int most_iterations,
                              const ResidualsAt& residuals_at) {
  MinimiseSquares* minimise = open_ceres();
  const std::size_t n = start.size();
  LeastSquares result;
  result.u = std::move(start);
  result.normal_inverse.resize(n * n);
  result.jacobian.resize(residuals * n);
  result.residuals.resize(residuals);
  result.effects.resize(n);
  Callback callback{.residuals_at = residuals_at, .unknowns = n, .residuals = residuals};
  SquaresProblem problem{.unknowns = n,
                         .residuals = residuals,
                         .most_iterations = most_iterations,
                         .difference_step = kDifferenceStep,
                         .context = &callback,
                         .residuals_at = call_back,
                         .u = result.u.data(),
                         .covariance = result.normal_inverse.data(),
                         .column_lengths = result.effects.data(),
                         .jacobian = result.jacobian.data(),
                         .residuals_at_u = result.residuals.data()};
  minimise(problem);
  if (callback.fault) std::rethrow_exception(callback.fault);
  result.has_converged = problem.has_converged;
  result.was_ended = callback.was_ended;
  result.reason = problem.reason;
  result.iterations = problem.iterations;
  result.squares_before = problem.squares_before;
  result.squares_after = problem.squares_after;
  if (!problem.has_covariance || residuals <= n) {
    for (std::vector<double>* one : {&result.normal_inverse, &result.jacobian, &result.residuals}) one->clear();
    return result;
  }
  for (std::size_t k = 0; k < n; ++k) {
    result.inflations.push_back(result.effects[k] * result.effects[k] * result.normal_inverse[k * n + k]);
  }
  return result;
}

bool has_least_squares() noexcept {
  return ::access(path_of_ceres().c_str(), R_OK) == 0;
}

}  // namespace slew::analysis
