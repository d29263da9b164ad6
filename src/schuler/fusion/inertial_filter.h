// Error-state inertial filter: nominal state, covariance, propagation with every IMU increment, closed-loop correction.
// It knows no sensor but the IMU; aids hand it rows (fusion/aid).
#pragma once

#include "schuler/core/samples.h"
#include "schuler/estim/scalar_update.h"
#include "schuler/estim/transition.h"
#include "schuler/fusion/frame.h"
#include "schuler/fusion/layout.h"
#include "schuler/fusion/settings.h"
#include "schuler/sensor/grades.h"

#include <Eigen/Core>

namespace schuler::fusion {

/// First-order process of one state: d' = -decay d + white; without decay a random walk.
struct StateProcess {
    double decay = 0.0;   ///< 1/s (0: constant or random walk)
    double psd = 0.0;     ///< unit^2/s
};

/// What does not change in a run.
template <int N>
struct InertialModel {
    earth::Earth earth;
    Layout layout;
    double gyro_psd = 0.0;    ///< rad^2/s
    double accel_psd = 0.0;   ///< m^2/s^3
    std::array<StateProcess, N> process{};   ///< of the states from 9 on
    sensor::GnssErrorModel gnss;             ///< of the receiver's states, whose decay may follow the speed
    Loop loop = Loop::Closed;
    Eigen::Matrix<double, N, 1> floor = Eigen::Matrix<double, N, 1>::Zero();   ///< least variances after an update
    estim::Sparsity<N> sparsity;

    InertialModel(const earth::Earth& earth_, const Layout& layout_, const sensor::ImuErrorModel& imu);
};

/// Extra noise of a step whose measurements were bridged (IMU gap), added to the densities of the model.
struct BridgeNoise {
    double gyro_psd = 0.0;
    double accel_psd = 0.0;
};

/// A measurement of up to three components with independent noise, rows in the filter's error states.
/// innovation = computed minus measured = row . error + noise (error = estimate minus truth).
template <int N>
struct Measurement {
    int dof = 0;
    Eigen::Matrix<double, N, 3> rows = Eigen::Matrix<double, N, 3>::Zero();  ///< column i is row i
    Eigen::Vector3d innovation = Eigen::Vector3d::Zero();
    Eigen::Vector3d variance = Eigen::Vector3d::Ones();
};

/// A plain copyable struct: copying it is saving the filter.
template <class Frame, int N>
struct InertialFilter {
    using Vector = Eigen::Matrix<double, N, 1>;
    using Matrix = Eigen::Matrix<double, N, N>;

    typename Frame::State nav;
    Vector parameters = Vector::Zero();   ///< nominal values of the states from 9 on
    Vector error = Vector::Zero();        ///< estimated errors of nav and parameters that are not fed back yet (zero in the closed loop)
    Matrix P = Matrix::Zero();            ///< of the errors, estimate minus truth

    Eigen::Matrix3d C = Eigen::Matrix3d::Identity();        ///< body to frame, of nav
    ImuIncrement previous{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< corrected for the sensor errors
    Eigen::Vector3d w_ib_b = Eigen::Vector3d::Zero();       ///< corrected rate of the last step, rad/s
    double cached_dt = -1.0;                                ///< of decay and noise below
    Vector cached_diagonal = Vector::Ones();
    Vector cached_q = Vector::Zero();

    [[nodiscard]] Time time() const { return nav.time; }
    void set_nav(const typename Frame::State& state);

    /// The increment less the estimated sensor errors.
    [[nodiscard]] ImuIncrement corrected(const InertialModel<N>& model, const ImuIncrement& raw) const;

    /// Advances by one raw increment; the transition is left in `phi`.
    void propagate(const InertialModel<N>& model, const ImuIncrement& raw, const BridgeNoise& bridge, estim::Transition<N>& phi);

    /// Innovation covariance (dof x dof used) of a measurement.
    [[nodiscard]] Eigen::Matrix3d innovation_covariance(const Measurement<N>& m) const;

    /// Sequential Joseph update and closed-loop correction. `record(ScalarUpdate)` is called for each scalar. Returns the error that
    /// was found.
    template <class Record>
    Vector update(const InertialModel<N>& model, const Measurement<N>& m, Record&& record) {
        Vector dx = Vector::Zero();
        for (int i = 0; i < m.dof; ++i) record(estim::update_scalar<N>(dx, P, m.rows.col(i), m.innovation(i), m.variance(i)));
        P.diagonal() = P.diagonal().cwiseMax(model.floor);
        apply(model, dx);
        return dx;
    }

    /// Correction with given gain columns; the covariance is that of the errors whatever the gains are.
    void correct(const InertialModel<N>& model, const Measurement<N>& m, const Eigen::Matrix<double, N, 3>& gains) {
        Vector dx = Vector::Zero();
        for (int i = 0; i < m.dof; ++i)
            (void)estim::update_with_gain<N>(dx, P, m.rows.col(i), m.innovation(i), m.variance(i), gains.col(i));
        apply(model, dx);
    }

    /// Corrects the estimate by dx: the nominal state in the closed loop, `error` otherwise.
    void apply(const InertialModel<N>& model, const Vector& dx);
    /// nominal <- corrected(nominal, error): the correction of the open or mixed loop. The estimate stays as it is.
    void feed_back(const InertialModel<N>& model);

    /// The estimate: nominal state and parameters, corrected by `error`.
    [[nodiscard]] typename Frame::State estimated(const InertialModel<N>& model) const;
    [[nodiscard]] Vector estimated_parameters() const;

    /// 9 x 9 map of the filter's first nine errors to north-east-down errors (identity in the geographic frame).
    [[nodiscard]] Matrix9 to_local_level(const InertialModel<N>& model) const;
};

}  // namespace schuler::fusion
