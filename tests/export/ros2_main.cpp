// Drives the plugin as the controller manager does, and the C controller beside it: test_ros2.py.
#include "ros2_hardware.hpp"

namespace
{

double drawn() { return 2.0 * std::rand() / RAND_MAX - 1.0; }

// The robot around its first posture: a slow motion within the ranges, feet in turn on the ground.
ng_board_readings moving(int tick)
{
    ng_board_readings readings = {};
    const double phase = 0.004 * tick;
    for (int leg = 0; leg < NG_LEGS; ++leg) {
        for (int i = 0; i < NG_LEG_JOINTS; ++i) {
            const double middle = 0.5 * (ng_board_lower[leg][i] + ng_board_upper[leg][i]);
            double angle = 0.5 * middle + 0.1 + 0.05 * std::sin(phase + leg + 2 * i);
            if (i == NG_LEG_JOINTS - 1) {
                // The leg that touches down at a multiple of 300 ticks is ahead then.
                angle = -0.3 * std::cos(M_PI * (tick - 300 * leg) / 300.0);
            }
            const int motor = ng_board_motor[leg][i];
            const double gear = ng_board_gear[leg][i], sign = ng_board_sign[leg][i];
            readings.position[motor] = gear * (sign * angle + ng_board_zero[leg][i]);
            readings.velocity[motor] = gear * sign * 0.2 * std::cos(phase + leg + 2 * i);
        }
        const double force = (tick / 300) % 2 == leg ? 200.0 : 0.0;
        readings.contact[ng_board_channel[leg]] =
            force / ng_board_newton[leg] + ng_board_no_contact[leg];
    }
    readings.pitch = NG_BOARD_PITCH_ZERO + 0.05 * NG_BOARD_PITCH_SIGN * std::sin(phase);
    readings.dpitch = 0.02 * drawn();
    readings.base_velocity[0] = 0.5;
    readings.time_us = 1000u * static_cast<unsigned>(tick + 1);
    return readings;
}

// The same tick by the C alone.
struct Reference
{
    ng_config config = ng_config_of(&ng_laws[0]);
    ng_state state;
    ng_estimator estimator;
    ng_command command;
    ng_real torques[NG_BOARD_MOTORS];
    ng_target targets[NG_BOARD_MOTORS];

    explicit Reference(bool measured) : measured_(measured)
    {
        config.blend_s = NG(0.25);
        ng_start(&state, 1);
        ng_estimator_start(&estimator);
    }
    void tick(ng_board_readings readings)
    {
        ng_encoders encoders;
        ng_measurement reading;
        if (!measured_) {
            std::memset(readings.velocity, 0, sizeof readings.velocity);
            std::memset(readings.base_velocity, 0, sizeof readings.base_velocity);
        }
        (void)ng_board_encoders(&readings, &encoders);
        ng_measure(&encoders, &reading);
        if (!measured_) {
            ng_estimate(&estimator, &state, &reading);
        }
        ng_step(&config, &state, &reading, &command);
        ng_board_torques(&command, torques);
        ng_board_targets(&reading, &command, targets);
    }

private:
    bool measured_;
};

// Activate, walk, fault, deactivate.
int walk(bool measured, bool impedance)
{
    auto plugin = make_plugin();
    auto & given = plugin->get_node()->parameters;
    Hardware hardware;
    if (measured) {
        given.emplace("base_velocity",
            ParameterValue(ParameterValue::Any(std::vector<std::string>{"base/x", "base/z"})));
    }
    given.emplace("mode",
        ParameterValue(ParameterValue::Any(std::string(impedance ? "impedance" : "effort"))));
    given.emplace("blend_s", ParameterValue(ParameterValue::Any(0.25)));
    given.emplace("stance_leg", ParameterValue(ParameterValue::Any(std::int64_t(1))));
    plugin->update_rate = 1000;
    if (plugin->on_init() != CallbackReturn::SUCCESS ||
        plugin->on_configure(kState) != CallbackReturn::SUCCESS) {
        return 1;
    }
    hardware.connect(*plugin);
    if (plugin->on_activate(kState) != CallbackReturn::SUCCESS) {
        return 1;
    }
    std::printf("silent %d\n", static_cast<int>(last(*plugin).status.size()));
    Reference own(measured);
    double worst = 0.0, most = 0.0;
    int ticks = 0, touchdowns = 0;
    for (; ticks < 2000; ++ticks) {
        const ng_board_readings readings = moving(ticks);
#if NG_COMMANDS
        if (ticks == 100) {
            auto message = std::make_shared<std_msgs::msg::Float64MultiArray>();
            ng_real wish[NG_COMMANDS];
            for (int i = 0; i < NG_COMMANDS; ++i) {
                message->data.push_back(ng_command_low[i]);
                wish[i] = ng_command_low[i];
            }
            const auto topic =
                std::static_pointer_cast<rclcpp::Subscription<std_msgs::msg::Float64MultiArray>>(
                    plugin->get_node()->subscribed);
            topic->receive(std::make_shared<std_msgs::msg::Float64MultiArray>());
            topic->receive(message);
            (void)ng_tell(&own.state, wish);
        }
#endif
        const rclcpp::Time time(1000 * static_cast<std::int64_t>(readings.time_us));
        show(hardware, readings, measured);
        if (plugin->update(time, kPeriod) != return_type::OK) {
            break;
        }
        own.tick(readings);
        touchdowns += own.command.touchdown;
        worse(worst, difference(hardware, own.torques, own.targets, impedance));
        worse(most, largest(hardware));
    }
#if NG_COMMANDS
    worse(worst, own.state.after[0] - ng_command_low[0]);
#endif
    std::printf("ticks %d\ntouchdowns %d\nworst %.3g\nlargest %.3g\n", ticks, touchdowns, worst, most);
    print(last(*plugin));
    hardware.states["imu/orientation.w"] = std::nan("");
    const rclcpp::Time next(1000000LL * (ticks + 1));
    const bool refused = plugin->update(next, kPeriod) == return_type::ERROR;
    double held = 0.0;
    for (const auto & [name, value] : hardware.commands) {
        if (name.find("/damping") == std::string::npos) {
            worse(held, value);
        }
    }
    std::printf("refused %d\nheld %.3g\ndamping %d\n", refused, held, largest(hardware) > 0.0);
    print(last(*plugin));
    (void)plugin->on_deactivate(kState);
    std::printf("after %.3g\n", largest(hardware));
    return 0;
}

int bad()
{
    auto plugin = make_plugin();
    auto & given = plugin->get_node()->parameters;
    const auto text = [](const char * value) {
        return ParameterValue(ParameterValue::Any(std::string(value)));
    };
    given.emplace("law", text("pid"));
    given.emplace("mode", text("force"));
    given.emplace("imu", text(""));
    given.emplace("blend_s", ParameterValue(ParameterValue::Any(-1.0)));
    given.emplace("stance_leg", ParameterValue(ParameterValue::Any(std::int64_t(2))));
    given.emplace("joints", ParameterValue(ParameterValue::Any(std::vector<std::string>{"a"})));
    given.emplace("contacts", ParameterValue(ParameterValue::Any(std::vector<std::string>{})));
    given.emplace("base_velocity",
        ParameterValue(ParameterValue::Any(std::vector<std::string>{"x"})));
    plugin->update_rate = 200;
    const bool begun = plugin->on_init() == CallbackReturn::SUCCESS;
    return begun && plugin->on_configure(kState) == CallbackReturn::FAILURE ? 0 : 1;
}

int other_type()
{
    auto plugin = make_plugin();
    plugin->get_node()->parameters.emplace("law", ParameterValue(ParameterValue::Any(1.0)));
    (void)plugin->on_init();
    return plugin->on_configure(kState) == CallbackReturn::FAILURE ? 0 : 1;
}

int lacking()
{
    auto plugin = make_plugin();
    (void)plugin->on_init();
    (void)plugin->on_configure(kState);
    return plugin->on_activate(kState) == CallbackReturn::ERROR ? 0 : 1;
}

}  // namespace

int main(int count, char ** words)
{
    const std::string word = count > 1 ? words[1] : "";
    return word == "bad" ? bad()
         : word == "type" ? other_type()
         : word == "lacking" ? lacking()
                             : walk(word.find("measured") == 0, word.find("impedance") != std::string::npos);
}
