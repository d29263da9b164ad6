// The processes started by mpirun, if the program is built with SCHULER_MPI.
#pragma once

#include "schuler/core/team.h"

#include <memory>

namespace schuler::cli {

/// The team of a program started as several processes; null for a single process. @throws Error(Input) if several processes are not supported.
[[nodiscard]] std::shared_ptr<Team> team_of_processes();

/// An error in one process usually occurs in all: the others wait until the first has reported it and terminated them.
void let_the_first_tell(const Team* team);

/// Terminates all processes of the team with an exit status, because one of them cannot continue.
void end_team(const Team& team, int status);

}  // namespace schuler::cli
