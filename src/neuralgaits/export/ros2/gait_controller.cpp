#include "gait_controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <set>
#include <type_traits>

#include "pluginlib/class_list_macros.hpp"

namespace neuralgaits_package
{

namespace
{

using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;

const char * const kOrientation[] = {"orientation.x", "orientation.y", "orientation.z",
                                     "orientation.w"};
const char * const kTargets[] = {"position", "velocity", "effort", "stiffness", "damping"};
#if NG_ROS2_SUPERVISOR
const char * const kRequests[] = {"damp", "stand", "walk"};  // in the order of ng_request

// The number of a request, or -1.
int request_of(const std::string & word)
{
    const auto at = std::find(std::begin(kRequests), std::end(kRequests), word);
    return at == std::end(kRequests) ? -1 : static_cast<int>(at - std::begin(kRequests));
}

std::string bad_request(const std::string & word)
{
    return "request: expected damp, stand or walk, found '" + word + "'";
}
#endif

// Releases of ros2_control differ in how a value is read.
template <typename Interface>
auto value_of(const Interface & one, int) -> std::decay_t<decltype(one.get_optional().value())>
{
    return one.get_optional().value_or(std::nan(""));
}

template <typename Interface>
double value_of(const Interface & one, long)
{
    return one.get_value();
}

std::string joined(const std::vector<std::string> & parts, const char * between)
{
    std::string whole;
    for (const auto & part : parts) {
        whole += (whole.empty() ? "" : between) + part;
    }
    return whole;
}

std::string laws()
{
    std::vector<std::string> names;
    for (int law = 0; law < NG_LAW_COUNT; ++law) {
        names.push_back(ng_laws[law].name);
    }
    return joined(names, ", ");
}

diagnostic_msgs::msg::KeyValue pair(const std::string & key, const std::string & value)
{
    diagnostic_msgs::msg::KeyValue one;
    one.key = key;
    one.value = value;
    return one;
}

// Where interfaces of these names stand; empty if one is missing.
template <typename Interfaces>
std::vector<std::size_t> places(
    const Interfaces & interfaces, const std::vector<std::string> & names)
{
    std::vector<std::size_t> found;
    for (const auto & name : names) {
        const auto at = std::find_if(
            interfaces.begin(), interfaces.end(),
            [&name](const auto & one) { return one.get_name() == name; });
        if (at == interfaces.end()) {
            return {};
        }
        found.push_back(static_cast<std::size_t>(at - interfaces.begin()));
    }
    return found;
}

}  // namespace

CallbackReturn GaitController::on_init()
{
    const auto names = [](const char * const * from, int count) {
        return std::vector<std::string>(from, from + count);
    };
    try {
        auto_declare<std::vector<std::string>>("joints", names(ng_ros2_joints, NG_BOARD_MOTORS));
        auto_declare<std::vector<std::string>>(
            "contacts", names(ng_ros2_contacts, NG_BOARD_CHANNELS));
        auto_declare<std::vector<std::string>>("base_velocity", {});
        auto_declare<std::string>("imu", "imu");
        auto_declare<std::string>("law", ng_laws[NG_LAW_DEFAULT].name);
        auto_declare<std::string>("mode", "effort");
#if NG_ROS2_SUPERVISOR
        auto_declare<std::string>("request", kRequests[NG_REQUEST_DAMP]);
#else
        auto_declare<double>("blend_s", 1.0);
        auto_declare<std::int64_t>("stance_leg", 0);
#endif
    } catch (const std::exception & error) {
        RCLCPP_ERROR(get_node()->get_logger(), "parameters: %s", error.what());
        return CallbackReturn::ERROR;
    }
    return CallbackReturn::SUCCESS;
}

// Every parameter that cannot be used, in words.
std::vector<std::string> GaitController::problems()
{
    std::vector<std::string> found;
    std::set<std::string> seen;
    if (joints_.size() != NG_BOARD_MOTORS) {
        found.push_back(
            "joints: expected " + std::to_string(NG_BOARD_MOTORS) + " names, one for each motor, "
            "found " + std::to_string(joints_.size()));
    }
    for (std::size_t motor = 0; motor < joints_.size() && motor < NG_BOARD_MOTORS; ++motor) {
        const bool used = ng_ros2_joints[motor][0] != '\0';
        if (used == joints_[motor].empty()) {
            found.push_back(
                "joints: expected " + std::string(used ? "a name" : "an empty name") +
                " for motor " + std::to_string(motor) + ", found '" + joints_[motor] + "'");
        } else if (used && !seen.insert(joints_[motor]).second) {
            found.push_back("joints: expected each name once, found " + joints_[motor] + " again");
        }
    }
    if (contacts_.size() != NG_BOARD_CHANNELS) {
        found.push_back(
            "contacts: expected " + std::to_string(NG_BOARD_CHANNELS) + " state interfaces, found " +
            std::to_string(contacts_.size()));
    }
    for (std::size_t channel = 0; channel < contacts_.size() && channel < NG_BOARD_CHANNELS;
         ++channel) {
        if (ng_ros2_contacts[channel][0] != '\0' && contacts_[channel].empty()) {
            found.push_back(
                "contacts: expected a state interface for channel " + std::to_string(channel) +
                ", found none");
        }
    }
    if (!base_velocity_.empty() && base_velocity_.size() != 2) {
        found.push_back(
            "base_velocity: expected two state interfaces (x, z) or none, found " +
            std::to_string(base_velocity_.size()));
    }
    if (imu_.empty()) {
        found.push_back("imu: expected the name of a sensor, found none");
    }
    if (mode_ != "effort" && mode_ != "impedance") {
        found.push_back("mode: expected effort or impedance, found '" + mode_ + "'");
    }
#if !NG_ROS2_SUPERVISOR
    if (!(blend_s_ >= 0.0 && blend_s_ <= 60.0)) {
        found.push_back("blend_s: expected 0 to 60, found " + std::to_string(blend_s_));
    }
    if (stance_leg_ != 0 && stance_leg_ != 1) {
        found.push_back("stance_leg: expected 0 or 1, found " + std::to_string(stance_leg_));
    }
#endif
    gait().law = nullptr;
    for (int law = 0; law < NG_LAW_COUNT; ++law) {
        if (law_ == ng_laws[law].name) {
#if NG_ROS2_SUPERVISOR
            config_ = ng_supervisor_config_of(&ng_laws[law]);
#else
            config_ = ng_config_of(&ng_laws[law]);
#endif
        }
    }
    if (gait().law == nullptr) {
        found.push_back("law: expected one of " + laws() + ", found '" + law_ + "'");
    }
    const double ticks_hz = 1.0 / static_cast<double>(NG_PERIOD);
    const double rate = static_cast<double>(get_update_rate());
    if (rate != 0.0 && std::abs(rate - ticks_hz) > 0.5) {
        found.push_back(
            "update_rate: expected " + std::to_string(std::lround(ticks_hz)) + " Hz, found " +
            std::to_string(std::lround(rate)));
    }
    return found;
}

CallbackReturn GaitController::on_configure(const rclcpp_lifecycle::State &)
{
    auto node = get_node();
    std::vector<std::string> found;
    try {
        joints_ = node->get_parameter("joints").as_string_array();
        contacts_ = node->get_parameter("contacts").as_string_array();
        base_velocity_ = node->get_parameter("base_velocity").as_string_array();
        imu_ = node->get_parameter("imu").as_string();
        law_ = node->get_parameter("law").as_string();
        mode_ = node->get_parameter("mode").as_string();
#if NG_ROS2_SUPERVISOR
        const std::string request = node->get_parameter("request").as_string();
        found = problems();
        if (request_of(request) < 0) {
            found.push_back(bad_request(request));
        }
#else
        blend_s_ = node->get_parameter("blend_s").as_double();
        stance_leg_ = node->get_parameter("stance_leg").as_int();
        found = problems();
#endif
    } catch (const std::exception & error) {
        found.push_back(error.what());
    }
    if (!found.empty()) {
        RCLCPP_ERROR(node->get_logger(), "parameters: %s", joined(found, "; ").c_str());
        return CallbackReturn::FAILURE;
    }
    if (const int failed = ng_selftest()) {
        RCLCPP_ERROR(
            node->get_logger(), "self-test: expected what Python computed, found a difference in "
            "line %d: build without -ffast-math", failed);
        return CallbackReturn::FAILURE;
    }
#if NG_ROS2_SUPERVISOR
    request_handle_ = node->add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> & changed) { return heed(changed); });
#else
    config_.blend_s = static_cast<ng_real>(blend_s_);
#endif
    publisher_ = node->create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", 10);
    timer_ = node->create_wall_timer(std::chrono::milliseconds(100), [this]() { publish(); });
#if NG_COMMANDS
    subscription_ = node->create_subscription<std_msgs::msg::Float64MultiArray>(
        "~/command", 1, [this](const std_msgs::msg::Float64MultiArray::SharedPtr message) {
            if (message->data.size() == NG_COMMANDS) {
                const std::lock_guard<std::mutex> lock(mutex_);
                requested_ = message->data;
                has_request_ = true;
            }
        });
#endif
    return CallbackReturn::SUCCESS;
}

InterfaceConfiguration GaitController::command_interface_configuration() const
{
    InterfaceConfiguration wanted{interface_configuration_type::INDIVIDUAL, {}};
    for (const auto & joint : joints_) {
        if (joint.empty()) {
            continue;
        }
        if (impedance()) {
            for (const char * name : kTargets) {
                wanted.names.push_back(joint + "/" + name);
            }
        } else {
            wanted.names.push_back(joint + "/effort");
        }
    }
    return wanted;
}

InterfaceConfiguration GaitController::state_interface_configuration() const
{
    InterfaceConfiguration wanted{interface_configuration_type::INDIVIDUAL, {}};
    for (const auto & joint : joints_) {
        if (!joint.empty()) {
            wanted.names.push_back(joint + "/position");
        }
    }
    for (const char * name : kOrientation) {
        wanted.names.push_back(imu_ + "/" + name);
    }
    wanted.names.push_back(imu_ + "/angular_velocity.y");
    for (const auto & contact : contacts_) {
        if (!contact.empty()) {
            wanted.names.push_back(contact);
        }
    }
    if (!estimates()) {
        for (const auto & joint : joints_) {
            if (!joint.empty()) {
                wanted.names.push_back(joint + "/velocity");
            }
        }
        wanted.names.insert(wanted.names.end(), base_velocity_.begin(), base_velocity_.end());
    }
    return wanted;
}

bool GaitController::place_interfaces()
{
    state_places_ = places(state_interfaces_, state_interface_configuration().names);
    command_places_ = places(command_interfaces_, command_interface_configuration().names);
    return !state_places_.empty() && !command_places_.empty();
}

CallbackReturn GaitController::on_activate(const rclcpp_lifecycle::State &)
{
    if (!place_interfaces()) {
        RCLCPP_ERROR(
            get_node()->get_logger(),
            "interfaces: expected %s and %s, found others: correct joints, imu and contacts",
            joined(command_interface_configuration().names, ", ").c_str(),
            joined(state_interface_configuration().names, ", ").c_str());
        return CallbackReturn::ERROR;
    }
#if NG_ROS2_SUPERVISOR
    // Whoever activates it again after a fault does not mean the walk before.
    const std::string request = get_node()->get_parameter("request").as_string();
    if (request != kRequests[NG_REQUEST_DAMP]) {
        RCLCPP_ERROR(
            get_node()->get_logger(),
            "request: expected damp at activation, found '%s': set the parameter to damp first",
            request.c_str());
        return CallbackReturn::FAILURE;
    }
    request_ = NG_REQUEST_DAMP;
#endif
    start();
    const std::lock_guard<std::mutex> lock(mutex_);
    snapshot_.valid = false;
    has_request_ = false;
    return CallbackReturn::SUCCESS;
}

// Before the first tick.
void GaitController::start()
{
#if NG_ROS2_SUPERVISOR
    ng_supervisor_start(&supervisor_);
    reason_ = NG_NO_CHANGE;
#else
    ng_start(&state_, static_cast<int>(stance_leg_));
#endif
    ng_estimator_start(&estimator_);
#if NG_ROS2_MONITOR
    ng_monitor_start(&monitor_);
#endif
}

#if NG_ROS2_SUPERVISOR
// A request counts from the next tick on; another word is refused.
rcl_interfaces::msg::SetParametersResult GaitController::heed(
    const std::vector<rclcpp::Parameter> & changed)
{
    rcl_interfaces::msg::SetParametersResult result;
    int request = -1;
    result.successful = true;
    for (const auto & one : changed) {
        if (one.get_name() != "request") {
            continue;
        }
        try {
            request = request_of(one.as_string());
            if (request < 0) {
                result.reason = bad_request(one.as_string());
            }
        } catch (const std::exception & error) {
            request = -1;
            result.reason = std::string("request: expected a text, ") + error.what();
        }
        result.successful = request >= 0;
    }
    if (request >= 0) {
        request_ = request;
    }
    return result;
}
#endif

CallbackReturn GaitController::on_deactivate(const rclcpp_lifecycle::State &)
{
    hold_still();
    const std::lock_guard<std::mutex> lock(mutex_);
    /* A fault is reported on; a robot that no longer walks is not said to. */
    snapshot_.valid = snapshot_.valid && snapshot_.command.fault != NG_NO_FAULT;
    return CallbackReturn::SUCCESS;
}

double GaitController::state(std::size_t place) const
{
    return value_of(state_interfaces_[state_places_[place]], 0);
}

void GaitController::set(std::size_t place, double value)
{
    (void)command_interfaces_[command_places_[place]].set_value(value);
}

void GaitController::read(const rclcpp::Time & time)
{
    std::size_t place = 0;
    readings_ = ng_board_readings{};
    readings_.time_us = static_cast<std::uint32_t>(time.nanoseconds() / 1000);
    for (std::size_t motor = 0; motor < joints_.size(); ++motor) {
        if (!joints_[motor].empty()) {
            readings_.position[motor] = static_cast<ng_real>(state(place++));
        }
    }
    const double x = state(place), y = state(place + 1), z = state(place + 2),
                 w = state(place + 3);
    place += 4;
    // The rotation about y, which is positive where the robot leans forward; NaN stays NaN.
    readings_.pitch =
        static_cast<ng_real>(std::atan2(2.0 * (w * y - z * x), 1.0 - 2.0 * (x * x + y * y)));
    readings_.dpitch = static_cast<ng_real>(state(place++));
    for (std::size_t channel = 0; channel < contacts_.size(); ++channel) {
        if (!contacts_[channel].empty()) {
            readings_.contact[channel] = static_cast<ng_real>(state(place++));
        }
    }
    if (!estimates()) {
        for (std::size_t motor = 0; motor < joints_.size(); ++motor) {
            if (!joints_[motor].empty()) {
                readings_.velocity[motor] = static_cast<ng_real>(state(place++));
            }
        }
        readings_.base_velocity[0] = static_cast<ng_real>(state(place));
        readings_.base_velocity[1] = static_cast<ng_real>(state(place + 1));
    }
}

void GaitController::write()
{
    std::size_t place = 0;
    ng_real torques[NG_BOARD_MOTORS];
    ng_target targets[NG_BOARD_MOTORS];
    ng_board_torques(&command_, torques);
#if NG_ROS2_SUPERVISOR
    ng_board_limit_targets(&reading_, supervisor_.targets);
    ng_board_map_targets(supervisor_.targets, targets);
#else
    ng_board_targets(&reading_, &command_, targets);
#endif
    for (std::size_t motor = 0; motor < joints_.size(); ++motor) {
        if (joints_[motor].empty()) {
            continue;
        }
        if (impedance()) {
            const ng_target & to = targets[motor];
            set(place, static_cast<double>(to.q_des));
            set(place + 1, static_cast<double>(to.dq_des));
            set(place + 2, static_cast<double>(to.tau_ff));
            set(place + 3, static_cast<double>(to.kp));
            set(place + 4, static_cast<double>(to.kd));
            place += 5;
        } else {
            set(place++, static_cast<double>(torques[motor]));
        }
    }
}

// Zero torque; drives with a loop of their own are told no gains.
void GaitController::hold_still()
{
    for (std::size_t place = 0; place < command_places_.size(); ++place) {
        set(place, 0.0);
    }
}

return_type GaitController::update(const rclcpp::Time & time, const rclcpp::Duration &)
{
#if NG_COMMANDS
    if (mutex_.try_lock()) {
        if (has_request_) {
            ng_real wish[NG_COMMANDS];
            std::transform(requested_.begin(), requested_.end(), wish, [](double value) {
                return static_cast<ng_real>(value);
            });
            (void)ng_tell(&gait_state(), wish);
            has_request_ = false;
        }
        mutex_.unlock();
    }
#endif
    ng_encoders encoders;
    read(time);
    outside_ = ng_board_encoders(&readings_, &encoders);
    ng_measure(&encoders, &reading_);
    if (estimates()) {
        ng_estimate(&estimator_, &gait_state(), &reading_);
    }
    control();
#if NG_ROS2_MONITOR
    monitor();
#endif
    write();
    if (mutex_.try_lock()) {
        snapshot_.command = command_;
#if NG_ROS2_SUPERVISOR
        snapshot_.decided = decided_;
        snapshot_.reason = reason_;
#endif
#if NG_ROS2_MONITOR
        snapshot_.answer = answer_;
        snapshot_.monitored = walks();
#endif
        snapshot_.outside = outside_;
        snapshot_.valid = true;
        mutex_.unlock();
    }
#if NG_ROS2_SUPERVISOR
    // Deactivated, it would not damp any more.
    return return_type::OK;
#else
    // Newer controller managers deactivate a controller that returns ERROR.
    return command_.fault == NG_NO_FAULT ? return_type::OK : return_type::ERROR;
#endif
}

// The tick of the controller itself.
void GaitController::control()
{
#if NG_ROS2_SUPERVISOR
    const auto request = static_cast<ng_request>(request_.load());
    ng_supervise(&config_, &supervisor_, &reading_, request, &decided_);
    command_ = decided_.command;
    command_.fault = decided_.fault;
    if (decided_.reason != NG_NO_CHANGE) {
        reason_ = decided_.reason;
    }
#else
    ng_step(&config_, &state_, &reading_, &command_);
#endif
}

#if NG_ROS2_MONITOR
// The proved sets are about walking: with each walk the monitor starts anew.
void GaitController::monitor()
{
    if (walks()) {
        ng_monitor_step(&monitor_, &gait_state(), reading_.time_us, &command_, &answer_);
    } else {
        ng_monitor_start(&monitor_);
    }
}
#endif

void GaitController::publish()
{
    Snapshot now;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        now = snapshot_;
    }
    if (!now.valid) {
        return;
    }
    using diagnostic_msgs::msg::DiagnosticStatus;
    DiagnosticStatus status;
    const bool fault = now.command.fault != NG_NO_FAULT;
    bool inside = true;
    status.name = "neuralgaits: " NG_ROBOT;
    status.hardware_id = NG_ROBOT;
    status.values.push_back(pair("fault", ng_fault_text(now.command.fault)));
    status.values.push_back(pair("stance leg", std::to_string(now.command.leg)));
    status.values.push_back(pair("policy sha256", NG_POLICY_SHA256));
    status.values.push_back(pair("motor of a joint outside of its range", now.outside == 0 ?
        "none" : std::to_string(now.outside - 1)));
#if NG_ROS2_MONITOR
    for (int k = 0; k < NG_MONITOR_LEVELS && !fault && now.monitored; ++k) {
        const ng_membership & one = now.answer.levels[k];
        const std::string level = "level " + std::to_string(one.level);
        inside = inside && one.inside;
        status.values.push_back(pair(level + " inside", one.inside ? "yes" : "no"));
        status.values.push_back(
            pair(level + " margin", std::to_string(static_cast<double>(one.margin))));
        status.values.push_back(pair(level + " margin of", one.name));
        status.values.push_back(
            pair(level + " outside since activation [us]", std::to_string(one.outside_us)));
    }
    if (now.monitored) {
        inside = inside && now.answer.admissible;
        status.values.push_back(pair("commands as proved", now.answer.admissible ? "yes" : "no"));
    }
    status.values.push_back(pair("proof sha256", NG_MONITOR_PROOF_SHA256));
#endif
    std::string mode = "walking";
    bool refuses = false;
#if NG_ROS2_SUPERVISOR
    mode = now.decided.mode == NG_WALK ? mode : ng_mode_text(now.decided.mode);
    refuses = now.decided.waiting == NG_FOR_DAMP || now.decided.waiting == NG_FOR_LEGS;
    status.values.push_back(pair("mode", ng_mode_text(now.decided.mode)));
    status.values.push_back(pair("reason of the last change", ng_reason_text(now.reason)));
    status.values.push_back(pair("request waits for", ng_waiting_text(now.decided.waiting)));
#endif
    const bool good = inside && now.outside == 0 && !refuses;
    status.level = fault ? DiagnosticStatus::ERROR
                 : good ? DiagnosticStatus::OK : DiagnosticStatus::WARN;
    status.message = fault ? ng_fault_text(now.command.fault)
                   : inside ? mode : mode + ", outside of a proved set";
    diagnostic_msgs::msg::DiagnosticArray array;
    array.header.stamp = get_node()->now();
    array.status.push_back(status);
    publisher_->publish(array);
}

}  // namespace neuralgaits_package

PLUGINLIB_EXPORT_CLASS(
    neuralgaits_package::GaitController, controller_interface::ControllerInterface)
