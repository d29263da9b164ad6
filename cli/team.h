// The processes that mpirun has started, where the program is built with SCHULER_MPI.
#pragma once

#include "schuler/core/team.h"

#include <memory>

namespace schuler::cli {

/// The team of a program that was started as several processes; null where it is alone. @throws Error(Input) where it is not, and cannot work so.
[[nodiscard]] std::shared_ptr<Team> team_of_processes();

/// What is wrong for one process is mostly wrong for all: the others wait until the first has said so and ended them.
void let_the_first_tell(const Team* team);

/// Ends all processes of the team at once, with an exit status: one of them cannot go on.
void end_team(const Team& team, int status);

}  // namespace schuler::cli
