/*
 * The controller as a process of its own: readings in and motor commands out, one UDP datagram
 * each, on loopback unless told otherwise. The protocol is on one page: docs/link.md.
 */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "amber_log.h"
#include "controller.h"
#include "estimator.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the link's numbers are little-endian: swap them in put and get"
#endif

#define JOINTS (NG_LEGS * NG_LEG_JOINTS)
#define HEAD 16
#define READING_BYTES (HEAD + 8 * (6 + 2 * JOINTS + NG_COMMANDS))
#define START_BYTES (HEAD + 8 * (2 + NG_COMMANDS))
#define COMMAND_BYTES (HEAD + 8 * (4 + 3 * NG_ACTUATED + 2 * JOINTS + 2 * NG_COMMANDS))
#define LARGEST 1024

enum { ESTIMATED = 1 }; /* of a reading: rates and velocity are not measured */
enum { LEG = 1, TOUCHDOWN = 2, SATURATED = 4, STALE = 8 };
enum { OTHER_LAW = 1, OTHER_COMMANDS = 2 }; /* why a start is refused */

typedef struct {
    int started;
    uint32_t sequence; /* of the last reading used */
    ng_config config;
    ng_state state;
    ng_estimator estimator;
    ng_measurement reading;
    ng_command command;
    double step_us; /* of the last tick */
} session;

static uint32_t get32(const unsigned char *from)
{
    uint32_t value;
    memcpy(&value, from, sizeof value);
    return value;
}

static const unsigned char *get(const unsigned char *from, ng_real *to, int count)
{
    for (int i = 0; i < count; ++i) {
        double value;
        memcpy(&value, from, sizeof value);
        to[i] = (ng_real)value;
        from += sizeof value;
    }
    return from;
}

static unsigned char *put(unsigned char *to, const ng_real *from, int count)
{
    for (int i = 0; i < count; ++i) {
        const double value = (double)from[i];
        memcpy(to, &value, sizeof value);
        to += sizeof value;
    }
    return to;
}

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

/* `NGS1`: which law, which leg, how long to blend, and at which commands if there are some. */
static int begin(session *s, const unsigned char *packet)
{
    const uint32_t law = get32(packet + 8), leg = get32(packet + 12);
    if (law >= NG_LAW_COUNT || leg > 1u) {
        return 0;
    }
    s->config = ng_config_of(&ng_laws[law]);
    ng_real options[2];
    const unsigned char *rest = get(packet + HEAD, options, 2);
    if (options[0] > NG(0.0) && ng_finite(options[0])) {
        s->config.blend_s = options[0];
    }
    if (options[1] > NG(0.0) && ng_finite(options[1])) {
        for (int i = 0; i < NG_ACTUATED; ++i) {
            s->config.torque_limit[i] = ng_clamp(options[1], NG(0.0), ng_torque_limit[i]);
        }
    }
#if NG_COMMANDS
    ng_real first[NG_COMMANDS];
    get(rest, first, NG_COMMANDS);
    ng_start_at(&s->state, (int)leg, first);
#else
    (void)rest;
    ng_start(&s->state, (int)leg);
#endif
    ng_estimator_start(&s->estimator);
    const ng_command nothing = {0};
    s->command = nothing;
    s->sequence = get32(packet + 4);
    s->started = 1;
    return 1;
}

/* `NGR1`: one tick, unless a later reading has been seen. Returns whether it was used. */
static int tick(session *s, const unsigned char *packet)
{
    const uint32_t ahead = get32(packet + 4) - s->sequence;
    ng_encoders encoders;
    if (ahead == 0u || ahead > 0x7fffffffu) {
        return 0;
    }
    encoders.time_us = get32(packet + 8);
    const unsigned char *at = packet + HEAD;
    at = get(at, &encoders.pitch, 1);
    at = get(at, &encoders.dpitch, 1);
    at = get(at, encoders.base_velocity, 2);
    at = get(at, encoders.normal_force, NG_LEGS);
    at = get(at, &encoders.joints[0][0], JOINTS);
    at = get(at, &encoders.djoints[0][0], JOINTS);
#if NG_COMMANDS
    ng_real requested[NG_COMMANDS];
    get(at, requested, NG_COMMANDS);
    ng_tell(&s->state, requested);
#else
    (void)at;
#endif
    const double began = now_us();
    ng_measure(&encoders, &s->reading);
    if (get32(packet + 12) & ESTIMATED) {
        ng_estimate(&s->estimator, &s->state, &s->reading);
    }
    ng_step(&s->config, &s->state, &s->reading, &s->command);
    s->step_us = now_us() - began;
    s->sequence = get32(packet + 4);
    return 1;
}

/* `NGC1`: the command of the last reading used. Returns its length. */
static size_t answer(const session *s, uint32_t sequence, int used, unsigned char *packet)
{
    const ng_command *command = &s->command;
    const uint32_t flags = (command->leg ? LEG : 0u) | (command->touchdown ? TOUCHDOWN : 0u) |
                           (command->saturated ? SATURATED : 0u) | (used ? 0u : STALE);
    const uint32_t fault = (uint32_t)command->fault;
    ng_real motors[NG_LEGS][NG_LEG_JOINTS];
    const ng_real times[2] = {command->since_touchdown, (ng_real)s->step_us};
    memcpy(packet, "NGC1", 4);
    memcpy(packet + 4, &sequence, 4);
    memcpy(packet + 8, &flags, 4);
    memcpy(packet + 12, &fault, 4);
    ng_drive(command, motors);
    unsigned char *at = put(packet + HEAD, &motors[0][0], JOINTS);
    at = put(at, &command->torque[0][0], JOINTS);
    at = put(at, command->actuated, NG_ACTUATED);
    at = put(at, command->y_d, NG_ACTUATED);
    at = put(at, command->dy_d, NG_ACTUATED);
    at = put(at, command->z, 2);
#if NG_COMMANDS
    at = put(at, s->state.before, NG_COMMANDS);
    at = put(at, s->state.after, NG_COMMANDS);
#endif
    put(at, times, 2);
    return COMMAND_BYTES;
}

/* Why a start cannot be one of this gait; 0 for none, and for other datagrams. */
static uint32_t refusal(const unsigned char *packet, ssize_t got)
{
    if (memcmp(packet, "NGS1", 4) != 0) {
        return 0u;
    }
    return got != START_BYTES ? OTHER_COMMANDS
           : get32(packet + 8) >= (uint32_t)NG_LAW_COUNT ? OTHER_LAW : 0u;
}

/* A socket bound to an address. Prints the port, which may have been left to the system. */
static int listen_on(const char *address, int port)
{
    struct sockaddr_in here;
    socklen_t length = sizeof here;
    memset(&here, 0, sizeof here);
    here.sin_family = AF_INET;
    here.sin_port = htons((uint16_t)port);
    const int handle = socket(AF_INET, SOCK_DGRAM, 0);
    if (handle < 0 || inet_pton(AF_INET, address, &here.sin_addr) != 1 ||
        bind(handle, (struct sockaddr *)&here, sizeof here) != 0 ||
        getsockname(handle, (struct sockaddr *)&here, &length) != 0) {
        perror("link: cannot listen");
        return -1;
    }
    printf("port %d\n", (int)ntohs(here.sin_port));
    fflush(stdout);
    return handle;
}

static int serve(int handle, FILE *log)
{
    static const char *const heads[] = {"NGS1", "NGR1", "NGQ1"};
    unsigned char packet[LARGEST], reply[LARGEST];
    session s = {0};
    double time_us = 0.0;
    uint32_t last_us = 0u;
    int timed = 0; /* whether last_us is of this episode */
    (void)log; /* without a log in the format of AMBER-3M */
    for (;;) {
        struct sockaddr_in peer;
        socklen_t length = sizeof peer;
        const ssize_t got =
            recvfrom(handle, packet, sizeof packet, 0, (struct sockaddr *)&peer, &length);
        size_t size = 0;
        if (got < 0) {
            perror("link: cannot receive");
            return 1;
        }
        if (got < HEAD) {
            continue; /* not of this protocol */
        }
        const uint32_t sequence = get32(packet + 4);
        if (memcmp(packet, heads[2], 4) == 0 && got == HEAD) {
            return 0;
        }
        const uint32_t why = refusal(packet, got);
        if (why != 0u) {
            const uint32_t about[2] = {why, why == OTHER_COMMANDS ? (uint32_t)NG_COMMANDS : 0u};
            memcpy(reply, "NGX1", 4);
            memcpy(reply + 4, &sequence, 4);
            memcpy(reply + 8, about, sizeof about);
            size = HEAD;
        } else if (memcmp(packet, heads[0], 4) == 0 && got == START_BYTES && begin(&s, packet)) {
            const uint32_t shape[2] = {NG_LEG_JOINTS, NG_ACTUATED};
            memcpy(reply, "NGA1", 4);
            memcpy(reply + 4, &sequence, 4);
            memcpy(reply + 8, shape, sizeof shape);
            size = HEAD;
            timed = 0;
        } else if (memcmp(packet, heads[1], 4) == 0 && got == READING_BYTES && s.started) {
            const int used = tick(&s, packet);
            size = answer(&s, sequence, used, reply);
            if (used) {
                const uint32_t at = s.reading.time_us;
                /* Rows of two episodes do not follow each other. */
                time_us += timed ? (double)(at - last_us) : time_us > 0.0 ? 1e6 : 0.0;
                last_us = at;
                timed = 1;
            }
#if NG_HAS_AMBER_LOG
            if (used && log != NULL && s.command.fault == NG_NO_FAULT &&
                ng_amber_row(log, 1e-3 * time_us, &s.reading, &s.command) < 0) {
                perror("link: cannot write the log");
                return 1;
            }
#endif
        }
        if (size > 0 && sendto(handle, reply, size, 0, (struct sockaddr *)&peer, length) < 0) {
            perror("link: cannot send");
        }
    }
}

int main(int argc, char **argv)
{
    const char *address = "127.0.0.1", *path = NULL;
    int port = 0;
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 < argc && strcmp(argv[i], "--port") == 0) {
            port = atoi(argv[i + 1]);
        } else if (i + 1 < argc && strcmp(argv[i], "--address") == 0) {
            address = argv[i + 1];
        } else if (i + 1 < argc && strcmp(argv[i], "--log") == 0) {
            path = argv[i + 1];
        } else {
            fprintf(stderr, "usage: link [--port N] [--address IPV4] [--log FILE.csv]\n");
            return 2;
        }
    }
    FILE *log = path == NULL ? NULL : fopen(path, "w");
    if (path != NULL && (log == NULL || !NG_HAS_AMBER_LOG)) {
        fprintf(stderr, "link: cannot write a log of this robot to %s\n", path);
        return 2;
    }
#if NG_HAS_AMBER_LOG
    if (log != NULL && ng_amber_header(log) < 0) {
        return 1;
    }
#endif
    const int handle = listen_on(address, port);
    const int failed = handle < 0 ? 1 : serve(handle, log);
    if (log != NULL && fclose(log) != 0) {
        return 1;
    }
    return failed;
}
