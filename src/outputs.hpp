#pragma once
#include <string>

#include "specialised.hpp"

/// What a drive shows of itself, number by number. Each has a channel, the same for all drives; a drive has some of them.
namespace strainwave::host {

/// How many channels there are.
inline constexpr int output_count = size_of<double, typename AnyDrive<double>::Output>;

/// Visits the outputs of a drive: output(name, field, part, channel). What stands in a group has its name in front.
template <class Visit>
class OutputWalk {
    const AnyDrive<double>& drive;
    const Visit& output;
    int& channel;
    const std::string part, group;

public:
    OutputWalk(const AnyDrive<double>& drive_, const Visit& output_, int& channel_, const std::string& part_ = "",
               const std::string& group_ = "")
        : drive(drive_), output(output_), channel(channel_), part(part_), group(group_) {}

    template <class T>
    void operator()(const T& member, const Field& field) const {
        if constexpr (is_storage<T>) {
            const int first = channel;
            drive.stateful_parts([&](const char* name, const auto& model) {
                if (same(name, field.name)) model.visit([&](const auto& chosen) { of_model(chosen, name); });
            });
            channel = first + size_of<double, T>;
        } else if constexpr (Described<T>) {
            T::fields(member, OutputWalk(drive, output, channel, part, std::string(field.name) + "_"));
        } else {
            output(group + field.name, field, part, channel++);
        }
    }

private:
    template <class Model>
    void of_model(const Model&, const char* name) const {
        if constexpr (requires { typename Model::Output; }) {
            const typename Model::Output own{};
            Model::Output::fields(own, OutputWalk(drive, output, channel, name));
        }
    }
};

template <class Visit>
void each_output(const AnyDrive<double>& drive, const Visit& visit) {
    int channel = 0;
    const AnyDrive<double>::Output output{};
    AnyDrive<double>::Output::fields(output, OutputWalk<Visit>(drive, visit, channel));
}

/// One more than the highest channel that a drive has.
inline int channels_of(const AnyDrive<double>& drive) {
    int count = 0;
    each_output(drive, [&](const std::string&, const Field&, const std::string&, int channel) { count = channel + 1; });
    return count;
}

}  // namespace strainwave::host
