// Covariance of the errors that one source causes in a filter that does not model it: under the filter's transitions and gains,
// together with the processes of the source. Steps between two updates are gathered into one, and the updates of one epoch likewise.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::estim {

/// Transition of a filter over several steps: the first nine rows, and the diagonal of the other states. Without shears.
struct GatheredTransition {
    static constexpr int coupled = Transition::coupled;
    using Rows = Eigen::Matrix<double, coupled, Eigen::Dynamic, 0, coupled, max_states>;

    Rows rows;             ///< 9 x states
    StateVector diagonal;  ///< entries from 9 on are used
    bool empty = true;     ///< the identity

    explicit GatheredTransition(int states = coupled) : rows(Rows::Zero(coupled, states)), diagonal(StateVector::Ones(states)) {
        reset();
    }
    void reset();
    /// One further step, which is later than those before. @pre no shears
    void add(const Transition& phi);
};

/// States are numbered as those of the filter: of the first nine the errors, of the others the estimates (in truth constant, so that the
/// processes of the source are their errors). Behind them the processes.
class JointCovariance {
public:
    static constexpr int coupled = Transition::coupled, most_processes = 9;
    using Matrix9 = Eigen::Matrix<double, coupled, coupled>;
    using Drive = Eigen::Matrix<double, coupled, Eigen::Dynamic, 0, coupled, most_processes>;
    using Processes = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_processes, 1>;

    /// `start`: of the first nine errors; `variance`: of each process.
    JointCovariance(int states, const Matrix9& start, const Processes& variance);

    /// One step of the filter. `phi`: its transition; `drive`: effect of the processes on the first nine errors (no columns: none);
    /// `decay`, `noise`: factor and added variance of each process; `white`: added covariance of the first nine errors, or null.
    void step(const Transition& phi, const Drive& drive, const Processes& decay, const Processes& noise, const Matrix9* white);
    /// Carries out the steps since the last time; `phi`: the filter's transition over them.
    void settle(const GatheredTransition& phi);
    /// One step of a filter with shears. @pre settled
    void step_with_shears(const Transition& phi, const Drive& drive, const Processes& decay, const Processes& noise,
                          const Matrix9* white);

    /// Correction by the filter with gain k for an innovation h . x + seen process + noise of variance `white`. `process`: the seen
    /// one, or -1. @pre settled
    void correct(const Row& h, const StateVector& k, int process, double seen, double white);

    /// A state of the filter starts again: its estimate is that of its prior. @pre settled
    void renew(int state);

    /// Variances of the first nine errors. @pre settled
    [[nodiscard]] Eigen::Matrix<double, coupled, 1> variances();

private:
    void carry_out_corrections();
    void add_noise();

    int states_, processes_, size_;  ///< size_: both, a multiple of four
    Eigen::MatrixXd S_;
    Drive drive_;  ///< since the last settle()
    Processes decay_;
    Matrix9 Q_errors_;
    Drive Q_cross_;
    Processes Q_processes_;
    bool driven_ = false, noisy_ = false;
    static constexpr int most_corrections = 16;
    Eigen::MatrixXd gains_, halves_;  ///< S <- S - k a^T - a k^T for each column, not yet carried out
    int corrections_ = 0;
    Eigen::VectorXd sh_;
    Eigen::Matrix<double, Eigen::Dynamic, coupled> rows_of_S_;  ///< A S, transposed
};

}  // namespace schuler::estim
