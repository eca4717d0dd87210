// Hardware of a plugin, as maps by name, and what it publishes: for ros2_main.cpp and its like.
#ifndef ROS2_HARDWARE_HPP
#define ROS2_HARDWARE_HPP

#include "gait_controller.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

std::unique_ptr<controller_interface::ControllerInterface> make_plugin();

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using diagnostic_msgs::msg::DiagnosticArray;
using rclcpp::ParameterValue;

inline const rclcpp_lifecycle::State kState;
inline const rclcpp::Duration kPeriod(1000000);

// Everything that hardware has, by the full name of its interface.
struct Hardware
{
    std::map<std::string, double> states, commands;

    void connect(controller_interface::ControllerInterface & plugin)
    {
        std::vector<hardware_interface::LoanedCommandInterface> out;
        std::vector<hardware_interface::LoanedStateInterface> in;
        for (const auto & name : plugin.command_interface_configuration().names) {
            out.emplace_back(name, &commands.emplace(name, 99.0).first->second);
        }
        for (const auto & name : plugin.state_interface_configuration().names) {
            in.emplace_back(name, &states.emplace(name, 0.0).first->second);
        }
        // In any order: the plugin finds its interfaces by name.
        std::vector<hardware_interface::LoanedStateInterface> turned(in.rbegin(), in.rend());
        plugin.assign(out, turned, 0);
    }
};

inline void show(Hardware & hardware, const ng_board_readings & readings, bool measured)
{
    for (int motor = 0; motor < NG_BOARD_MOTORS; ++motor) {
        const std::string name = ng_ros2_joints[motor];
        if (!name.empty()) {
            hardware.states[name + "/position"] = readings.position[motor];
            if (measured) {
                hardware.states[name + "/velocity"] = readings.velocity[motor];
            }
        }
    }
    hardware.states["imu/orientation.x"] = 0.0;
    hardware.states["imu/orientation.y"] = std::sin(0.5 * readings.pitch);
    hardware.states["imu/orientation.z"] = 0.0;
    hardware.states["imu/orientation.w"] = std::cos(0.5 * readings.pitch);
    hardware.states["imu/angular_velocity.y"] = readings.dpitch;
    for (int channel = 0; channel < NG_BOARD_CHANNELS; ++channel) {
        hardware.states[ng_ros2_contacts[channel]] = readings.contact[channel];
    }
    hardware.states["base/x"] = readings.base_velocity[0];
    hardware.states["base/z"] = readings.base_velocity[1];
}

inline void worse(double & worst, double value)
{
    if (!(std::abs(value) <= worst)) {
        worst = std::abs(value);
    }
}

// Largest difference between what the plugin wrote and what the C alone gives.
inline double difference(
    const Hardware & hardware, const ng_real * torques, const ng_target * targets, bool impedance)
{
    double worst = 0.0;
    for (int motor = 0; motor < NG_BOARD_MOTORS; ++motor) {
        const std::string joint = ng_ros2_joints[motor];
        if (joint.empty()) {
            continue;
        }
        const auto at = [&](const char * name) { return hardware.commands.at(joint + "/" + name); };
        if (!impedance) {
            worse(worst, at("effort") - torques[motor]);
            continue;
        }
        const ng_target & to = targets[motor];
        worse(worst, at("position") - to.q_des);
        worse(worst, at("velocity") - to.dq_des);
        worse(worst, at("effort") - to.tau_ff);
        worse(worst, at("stiffness") - to.kp);
        worse(worst, at("damping") - to.kd);
    }
    return worst;
}

inline DiagnosticArray last(controller_interface::ControllerInterface & plugin)
{
    auto node = plugin.get_node();
    node->timer->fire();
    const auto seen =
        std::static_pointer_cast<rclcpp::Publisher<DiagnosticArray>>(node->published);
    return seen->messages.empty() ? DiagnosticArray{} : seen->messages.back();
}

inline void print(const DiagnosticArray & array)
{
    for (const auto & status : array.status) {
        std::printf("status %d %s\n", status.level, status.message.c_str());
        for (const auto & one : status.values) {
            std::printf("value %s: %s\n", one.key.c_str(), one.value.c_str());
        }
    }
}

inline double largest(const Hardware & hardware)
{
    double found = 0.0;
    for (const auto & [name, value] : hardware.commands) {
        worse(found, value);
    }
    return found;
}

#endif
