// run.mat: the tables of run.h5 for Octave and MATLAB, a struct per group (docs/octave.md).
#pragma once

#include "schuler/solution/bundle.h"

#include <filesystem>

namespace schuler::report {

void write_run_mat(const std::filesystem::path& file, const solution::ResultBundle& bundle);

}  // namespace schuler::report
