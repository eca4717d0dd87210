// Drives a plugin with the supervisor, and the supervisor in C beside it: test_ros2_supervised.py.
#include "ros2_hardware.hpp"
#include "supervisor_readings.h"

namespace
{

// The readings of the joints as drives and sensors show them.
ng_board_readings as_hardware(const ng_encoders & encoders)
{
    ng_board_readings readings = {};
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const int motor = ng_board_motor[leg][i];
            const double gear = ng_board_gear[leg][i], sign = ng_board_sign[leg][i];
            readings.position[motor] =
                gear * (sign * encoders.joints[leg][i] + ng_board_zero[leg][i]);
            readings.velocity[motor] = gear * sign * encoders.djoints[leg][i];
        }
        readings.contact[ng_board_channel[leg]] =
            encoders.normal_force[leg] / ng_board_newton[leg] + ng_board_no_contact[leg];
    }
    readings.pitch = NG_BOARD_PITCH_ZERO + NG_BOARD_PITCH_SIGN * encoders.pitch;
    readings.base_velocity[0] = encoders.base_velocity[0];
    readings.time_us = encoders.time_us;
    return readings;
}

// The same tick by the C alone.
struct Reference
{
    ng_supervisor_config config = ng_supervisor_config_of(&ng_laws[0]);
    ng_supervisor supervisor;
    ng_supervision decided;
    ng_measurement reading;
    ng_real torques[NG_BOARD_MOTORS];
    ng_target targets[NG_BOARD_MOTORS];

    Reference() { ng_supervisor_start(&supervisor); }
    void tick(const ng_board_readings & readings, ng_request request)
    {
        ng_encoders encoders;
        (void)ng_board_encoders(&readings, &encoders);
        ng_measure(&encoders, &reading);
        ng_supervise(&config, &supervisor, &reading, request, &decided);
        ng_board_torques(&decided.command, torques);
        ng_board_limit_targets(&reading, supervisor.targets);
        ng_board_map_targets(supervisor.targets, targets);
    }
};

// Torque beyond the deployment file's that drives give at the reading [N m]; damping is left alone.
double beyond(Hardware & hardware)
{
    double worst = 0.0;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const std::string joint = ng_ros2_joints[ng_board_motor[leg][i]];
            const auto at = [&](const std::string & of) { return hardware.commands.at(joint + of); };
            const double q = hardware.states.at(joint + "/position");
            const double dq = hardware.states.at(joint + "/velocity");
            const double torque = at("/effort") + at("/stiffness") * (at("/position") - q) +
                                  at("/damping") * (at("/velocity") - dq);
            const double limit = ng_board_torque_limit[leg][i] / ng_board_gear[leg][i];
            if (at("/stiffness") != 0.0 && std::isfinite(torque)) {
                worse(worst, std::max(0.0, std::abs(torque) - limit));
            }
        }
    }
    return worst;
}

rclcpp::ParameterValue text(const char * value)
{
    return ParameterValue(ParameterValue::Any(std::string(value)));
}

rcl_interfaces::msg::SetParametersResult request(
    controller_interface::ControllerInterface & plugin, const char * word)
{
    return plugin.get_node()->set_parameter(rclcpp::Parameter("request", text(word)), text(word));
}

int walk(bool impedance)
{
    auto plugin = make_plugin();
    auto & given = plugin->get_node()->parameters;
    Hardware hardware;
    given.emplace("base_velocity",
        ParameterValue(ParameterValue::Any(std::vector<std::string>{"base/x", "base/z"})));
    given.emplace("mode", text(impedance ? "impedance" : "effort"));
    plugin->update_rate = 1000;
    if (plugin->on_init() != CallbackReturn::SUCCESS ||
        plugin->on_configure(kState) != CallbackReturn::SUCCESS) {
        return 1;
    }
    hardware.connect(*plugin);
    if (plugin->on_activate(kState) != CallbackReturn::SUCCESS) {
        return 1;
    }
    static const char * const words[] = {"damp", "stand", "walk"};
    Reference own;
    double worst = 0.0, most = 0.0, over = 0.0;
    int modes[4] = {0, 0, 0, 0}, ok = 1, faults = 0, now = NG_REQUEST_DAMP;
    ng_encoders encoders = {};
    for (int tick = 0; tick < 12000; ++tick) {
        draw_readings(&encoders, tick);
        const ng_board_readings readings = as_hardware(encoders);
        const int at = tick % 4000;
        const int wanted = at == 3999 || at < 5 ? 0 : 1 + (at >= 1200 && at < 2800);
        if (wanted != now) {
            ok &= request(*plugin, words[wanted]).successful;
            now = wanted;
        }
        show(hardware, readings, true);
        const rclcpp::Time time(1000 * static_cast<std::int64_t>(readings.time_us));
        ok &= plugin->update(time, kPeriod) == return_type::OK;
        own.tick(readings, static_cast<ng_request>(wanted));
        modes[own.decided.mode] += 1;
        faults += own.decided.fault_is_new;
        worse(worst, difference(hardware, own.torques, own.targets, impedance));
        worse(most, largest(hardware));
        if (impedance) {
            worse(over, beyond(hardware));
        }
        if (at == 1000 || at == 1400 || tick == 11000) {
            print(last(*plugin));
        }
    }
    std::printf("ok %d\nfaults %d\nworst %.3g\nlargest %.3g\nbeyond %.3g\n", ok, faults, worst,
                most, over);
    std::printf("modes %d,%d,%d,%d\n", modes[0], modes[1], modes[2], modes[3]);
    const auto refused = request(*plugin, "run");
    std::printf("refused %d %s\n", refused.successful, refused.reason.c_str());
    const auto number = ParameterValue(ParameterValue::Any(1.0));
    std::printf("number %d\n", plugin->get_node()->set_parameter(
        rclcpp::Parameter("request", number), number).successful);
    (void)request(*plugin, "walk");
    (void)plugin->on_deactivate(kState);
    std::printf("after %.3g\n", largest(hardware));
    std::printf("again %d\n", plugin->on_activate(kState) == CallbackReturn::SUCCESS);
    (void)request(*plugin, "damp");
    std::printf("later %d\n", plugin->on_activate(kState) == CallbackReturn::SUCCESS);
    return 0;
}

int bad()
{
    auto plugin = make_plugin();
    plugin->get_node()->parameters.emplace("request", text("sit"));
    (void)plugin->on_init();
    return plugin->on_configure(kState) == CallbackReturn::FAILURE ? 0 : 1;
}

}  // namespace

int main(int count, char ** words)
{
    const std::string word = count > 1 ? words[1] : "";
    return word == "bad" ? bad() : walk(word == "impedance");
}
