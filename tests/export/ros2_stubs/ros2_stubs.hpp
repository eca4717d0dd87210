// The few classes of ROS 2 that the plugin uses, written from their public interfaces: no ROS here.
// They check what a plugin asks for, and keep what it prints and publishes for the test to see.
#ifndef ROS2_STUBS_HPP
#define ROS2_STUBS_HPP

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace diagnostic_msgs::msg
{
struct KeyValue
{
    std::string key, value;
};
struct DiagnosticStatus
{
    static constexpr unsigned char OK = 0, WARN = 1, ERROR = 2, STALE = 3;
    unsigned char level = OK;
    std::string name, message, hardware_id;
    std::vector<KeyValue> values;
};
}  // namespace diagnostic_msgs::msg

namespace rclcpp
{
class Time
{
public:
    Time() : nanoseconds_(0) {}
    explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
    std::int64_t nanoseconds() const { return nanoseconds_; }

private:
    std::int64_t nanoseconds_;
};

class Duration
{
public:
    explicit Duration(std::int64_t nanoseconds = 0) : nanoseconds_(nanoseconds) {}
    double seconds() const { return 1e-9 * static_cast<double>(nanoseconds_); }

private:
    std::int64_t nanoseconds_;
};

struct Header
{
    Time stamp;
    std::string frame_id;
};

class Logger
{
};

class TimerBase
{
public:
    using SharedPtr = std::shared_ptr<TimerBase>;
    explicit TimerBase(std::function<void()> work) : fire(std::move(work)) {}
    std::function<void()> fire;
};

template <typename Message>
class Publisher
{
public:
    using SharedPtr = std::shared_ptr<Publisher<Message>>;
    void publish(const Message & message) { messages.push_back(message); }
    std::vector<Message> messages;
};

template <typename Message>
class Subscription
{
public:
    using SharedPtr = std::shared_ptr<Subscription<Message>>;
    std::function<void(std::shared_ptr<Message>)> receive;
};

class ParameterValue
{
public:
    using Any = std::variant<
        std::vector<std::string>, std::string, double, std::int64_t>;
    ParameterValue() = default;
    explicit ParameterValue(Any value) : value_(std::move(value)) {}
    std::vector<std::string> as_string_array() const { return get<std::vector<std::string>>(); }
    std::string as_string() const { return get<std::string>(); }
    double as_double() const { return get<double>(); }
    std::int64_t as_int() const { return get<std::int64_t>(); }

private:
    template <typename T>
    T get() const
    {
        if (!std::holds_alternative<T>(value_)) {
            throw std::runtime_error("expected a parameter of another type");
        }
        return std::get<T>(value_);
    }
    Any value_;
};

class Parameter
{
public:
    Parameter(std::string name, ParameterValue value) : name_(name), value_(value) {}
    const std::string & get_name() const { return name_; }
    std::string as_string() const { return value_.as_string(); }

private:
    std::string name_;
    ParameterValue value_;
};
}  // namespace rclcpp

namespace rcl_interfaces::msg
{
struct SetParametersResult
{
    bool successful = false;
    std::string reason;
};
}  // namespace rcl_interfaces::msg

namespace diagnostic_msgs::msg
{
struct DiagnosticArray
{
    rclcpp::Header header;
    std::vector<DiagnosticStatus> status;
};
}  // namespace diagnostic_msgs::msg

namespace std_msgs::msg
{
struct Float64MultiArray
{
    using SharedPtr = std::shared_ptr<Float64MultiArray>;
    std::vector<double> data;
};
}  // namespace std_msgs::msg

namespace rclcpp_lifecycle
{
class State
{
};

// Keeps its parameters, timers and topics where the test finds them.
class LifecycleNode
{
public:
    rclcpp::Logger get_logger() const { return {}; }
    rclcpp::Time now() const { return rclcpp::Time(7); }
    rclcpp::ParameterValue get_parameter(const std::string & name) const
    {
        return parameters.at(name);
    }
    template <typename Message>
    typename rclcpp::Publisher<Message>::SharedPtr create_publisher(const std::string &, int)
    {
        auto made = std::make_shared<rclcpp::Publisher<Message>>();
        published = made;
        return made;
    }
    template <typename Message, typename Work>
    typename rclcpp::Subscription<Message>::SharedPtr create_subscription(
        const std::string &, int, Work work)
    {
        auto made = std::make_shared<rclcpp::Subscription<Message>>();
        made->receive = work;
        subscribed = made;
        return made;
    }
    rclcpp::TimerBase::SharedPtr create_wall_timer(
        std::chrono::milliseconds, std::function<void()> work)
    {
        timer = std::make_shared<rclcpp::TimerBase>(work);
        return timer;
    }
    using Heeds = std::function<rcl_interfaces::msg::SetParametersResult(
        const std::vector<rclcpp::Parameter> &)>;
    // Lives as long as the node's owner keeps it, as in ROS.
    std::shared_ptr<Heeds> add_on_set_parameters_callback(Heeds heeds)
    {
        auto made = std::make_shared<Heeds>(std::move(heeds));
        heeds_ = made;
        return made;
    }
    // What `ros2 param set` does.
    rcl_interfaces::msg::SetParametersResult set_parameter(const rclcpp::Parameter & one,
                                                           rclcpp::ParameterValue value)
    {
        const auto heeds = heeds_.lock();
        const auto result =
            heeds ? (*heeds)({one}) : rcl_interfaces::msg::SetParametersResult{true, ""};
        if (result.successful) {
            parameters[one.get_name()] = value;
        }
        return result;
    }
    std::map<std::string, rclcpp::ParameterValue> parameters;
    rclcpp::TimerBase::SharedPtr timer;
    std::shared_ptr<void> published, subscribed;

private:
    std::weak_ptr<Heeds> heeds_;
};
}  // namespace rclcpp_lifecycle

namespace hardware_interface
{
class LoanedStateInterface
{
public:
    LoanedStateInterface(std::string name, const double * value) : name_(name), value_(value) {}
    std::string get_name() const { return name_; }
#ifdef STUB_OF_LATER_RELEASE
    template <typename T = double>
    std::optional<T> get_optional(unsigned = 10) const
    {
        return *value_;
    }
#else
    double get_value() const { return *value_; }
#endif

private:
    std::string name_;
    const double * value_;
};

class LoanedCommandInterface
{
public:
    LoanedCommandInterface(std::string name, double * value) : name_(name), value_(value) {}
    std::string get_name() const { return name_; }
#ifdef STUB_OF_LATER_RELEASE
    [[nodiscard]] bool set_value(double value)
    {
        *value_ = value;
        return true;
    }
#else
    void set_value(double value) { *value_ = value; }
#endif

private:
    std::string name_;
    double * value_;
};
}  // namespace hardware_interface

namespace controller_interface
{
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration
{
    interface_configuration_type type;
    std::vector<std::string> names = {};
};

class ControllerInterface
{
public:
    virtual ~ControllerInterface() = default;
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;
    virtual CallbackReturn on_init() = 0;
    virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &)
    {
        return CallbackReturn::SUCCESS;
    }
    virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &)
    {
        return CallbackReturn::SUCCESS;
    }
    virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &)
    {
        return CallbackReturn::SUCCESS;
    }
    virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;

    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }
    unsigned int get_update_rate() const { return update_rate; }

    // As the controller manager does.
    template <typename T>
    void assign(
        std::vector<hardware_interface::LoanedCommandInterface> commands,
        std::vector<hardware_interface::LoanedStateInterface> states, T)
    {
        command_interfaces_ = std::move(commands);
        state_interfaces_ = std::move(states);
    }
    unsigned int update_rate = 0;

protected:
    // A parameter that a file has given keeps that value.
    template <typename T>
    void auto_declare(const std::string & name, const T & usual)
    {
        if (!node_->parameters.count(name)) {
            node_->parameters.emplace(name, rclcpp::ParameterValue(rclcpp::ParameterValue::Any(usual)));
        }
    }
    std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
    std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

private:
    std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ =
        std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};
}  // namespace controller_interface

#define RCLCPP_ERROR(logger, ...) \
    do { \
        (void)(logger); \
        std::fprintf(stderr, __VA_ARGS__); \
        std::fprintf(stderr, "\n"); \
    } while (0)
#define PLUGINLIB_EXPORT_CLASS(derived, base) \
    std::unique_ptr<base> make_plugin() { return std::make_unique<derived>(); }

#endif
