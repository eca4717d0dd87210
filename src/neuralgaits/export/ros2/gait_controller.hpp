// A walking gait as a ros2_control controller: the exported C between state and command interfaces.
//
// Written by a program. The C beside it computes; this class carries readings to it and torques from
// it, and publishes what the controller and its monitor say.
#ifndef NG_ROS2_GAIT_CONTROLLER_HPP
#define NG_ROS2_GAIT_CONTROLLER_HPP

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "controller_interface/controller_interface.hpp"
#include "diagnostic_msgs/msg/diagnostic_array.hpp"
#include "rclcpp/rclcpp.hpp"
#include "std_msgs/msg/float64_multi_array.hpp"

#include "ros2_facts.h"
#if NG_ROS2_SUPERVISOR
#include "rcl_interfaces/msg/set_parameters_result.hpp"
#endif

extern "C" {
#include "board_map.h"
#include "estimator.h"
#if NG_ROS2_SUPERVISOR
#include "supervisor.h"
#endif
#if NG_ROS2_MONITOR
#include "monitor.h"
#endif
}

namespace neuralgaits_package
{

using CallbackReturn = controller_interface::CallbackReturn;

class GaitController : public controller_interface::ControllerInterface
{
public:
    CallbackReturn on_init() override;

    // joint/effort, or with mode "impedance" five command interfaces for each joint.
    controller_interface::InterfaceConfiguration command_interface_configuration() const override;

    // joint/position, the inertial unit, contacts; rates only where they are not estimated.
    controller_interface::InterfaceConfiguration state_interface_configuration() const override;

    CallbackReturn on_configure(const rclcpp_lifecycle::State & previous) override;
    CallbackReturn on_activate(const rclcpp_lifecycle::State & previous) override;
    CallbackReturn on_deactivate(const rclcpp_lifecycle::State & previous) override;

    // One tick. Returns ERROR after a fault, with zero torque or damping on every joint; a supervisor
    // goes on damping and returns OK.
    controller_interface::return_type update(
        const rclcpp::Time & time, const rclcpp::Duration & period) override;

private:
    // What is published, copied out of the tick.
    struct Snapshot
    {
        ng_command command;
#if NG_ROS2_SUPERVISOR
        ng_supervision decided;
        ng_reason reason;  // of the last change of mode
#endif
#if NG_ROS2_MONITOR
        ng_monitor_answer answer;
        bool monitored;
#endif
        int outside;  // 1 + the motor of a joint outside of its range, or 0
        bool valid;
    };

    std::vector<std::string> problems();
    bool estimates() const { return base_velocity_.empty(); }
    bool impedance() const { return mode_ == "impedance"; }
    void read(const rclcpp::Time & time);
    void write();
    void hold_still();
    void set(std::size_t place, double value);
    double state(std::size_t place) const;
    bool place_interfaces();
    void publish();
    void start();
    void control();
#if NG_ROS2_MONITOR
    void monitor();
#endif
#if NG_ROS2_SUPERVISOR
    rcl_interfaces::msg::SetParametersResult heed(const std::vector<rclcpp::Parameter> & changed);
#endif

    // Parameters.
    std::vector<std::string> joints_;         // by motor index; empty for a motor without a joint
    std::vector<std::string> contacts_;       // state interfaces, by channel
    std::vector<std::string> base_velocity_;  // two state interfaces (x, z), or none to estimate
    std::string imu_;
    std::string law_;
    std::string mode_;
#if !NG_ROS2_SUPERVISOR
    double blend_s_ = 0.0;
    std::int64_t stance_leg_ = 0;
#endif

    // The order of interfaces in the vectors of the base class.
    std::vector<std::size_t> state_places_;
    std::vector<std::size_t> command_places_;

#if NG_ROS2_SUPERVISOR
    ng_supervisor_config config_{};
    ng_supervisor supervisor_{};
    ng_supervision decided_{};
    ng_reason reason_ = NG_NO_CHANGE;
    std::atomic<int> request_{NG_REQUEST_DAMP};  // written by the parameter's callback
    std::shared_ptr<void> request_handle_;
    ng_config & gait() { return config_.walk; }
    ng_state & gait_state() { return supervisor_.state; }
    bool walks() const { return supervisor_.mode == NG_WALK; }
#else
    ng_config config_{};
    ng_state state_{};
    ng_config & gait() { return config_; }
    ng_state & gait_state() { return state_; }
    bool walks() const { return true; }
#endif
    ng_estimator estimator_{};
    ng_board_readings readings_{};
    ng_measurement reading_{};
    ng_command command_{};
#if NG_ROS2_MONITOR
    ng_monitor monitor_{};
    ng_monitor_answer answer_{};
#endif

    int outside_ = 0;
    std::mutex mutex_;  // never waited for in a tick
    Snapshot snapshot_{};
    std::vector<double> requested_;
    bool has_request_ = false;
    // Of the base class of publishers: a lifecycle publisher would be silent until it is activated.
    rclcpp::Publisher<diagnostic_msgs::msg::DiagnosticArray>::SharedPtr publisher_;
    rclcpp::Subscription<std_msgs::msg::Float64MultiArray>::SharedPtr subscription_;
    rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace neuralgaits_package

#endif
