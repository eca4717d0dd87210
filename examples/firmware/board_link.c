/*
 * A board that is no board: encoders and drives are datagrams of docs/link.md, so that the very
 * main loop of the robot walks in a simulator. Set LINK_PORT for a port of your own choice, and
 * LINK_ADDRESS for another than 127.0.0.1.
 */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "board.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the link's numbers are little-endian: swap them in get_numbers and put_numbers"
#endif

#define JOINTS (NG_LEGS * NG_LEG_JOINTS)
#define HEAD 16
#define READING_BYTES (HEAD + 8 * (6 + 2 * JOINTS + NG_COMMANDS))
#define START_BYTES (HEAD + 8 * (2 + NG_COMMANDS))
#define LARGEST 1024

enum { LEG = 1, TOUCHDOWN = 2, SATURATED = 4, STALE = 8 };
enum { OTHER_LAW = 1, OTHER_COMMANDS = 2 }; /* why a start is refused */
enum { IDLE, STARTING, RUNNING };

/* All that this board knows. Ahead of the controller it is a wire and no more. */
static struct {
    int handle;
    int phase;
    struct sockaddr_in peer;
    socklen_t peer_bytes;
    unsigned char start[LARGEST]; /* the latest `NGS1` */
    unsigned char reading[LARGEST]; /* the latest `NGR1` that was used */
    unsigned char reply[LARGEST]; /* to it */
    size_t reply_bytes;
    ng_real motors[NG_LEGS][NG_LEG_JOINTS];
    double began_us; /* when the reading came */
} board;

static uint32_t get32(const unsigned char *from)
{
    uint32_t value;
    memcpy(&value, from, sizeof value);
    return value;
}

static const unsigned char *get_numbers(const unsigned char *from, ng_real *to, int count)
{
    for (int i = 0; i < count; ++i, from += 8) {
        double value;
        memcpy(&value, from, sizeof value);
        to[i] = (ng_real)value;
    }
    return from;
}

static unsigned char *put_numbers(unsigned char *to, const ng_real *from, int count)
{
    for (int i = 0; i < count; ++i, to += 8) {
        const double value = (double)from[i];
        memcpy(to, &value, sizeof value);
    }
    return to;
}

static unsigned char *put_head(unsigned char *to, const char *letters, uint32_t a, uint32_t b,
                               uint32_t c)
{
    const uint32_t numbers[3] = {a, b, c};
    memcpy(to, letters, 4);
    memcpy(to + 4, numbers, sizeof numbers);
    return to + HEAD;
}

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static void give_up(const char *what)
{
    perror(what);
    exit(1);
}

/* Print the port, which may have been left to the system. */
static void listen_once(void)
{
    const char *port = getenv("LINK_PORT"), *address = getenv("LINK_ADDRESS");
    struct sockaddr_in here;
    socklen_t bytes = sizeof here;
    if (board.handle > 0) {
        return;
    }
    memset(&here, 0, sizeof here);
    here.sin_family = AF_INET;
    here.sin_port = htons((uint16_t)(port == NULL ? 0 : atoi(port)));
    board.handle = socket(AF_INET, SOCK_DGRAM, 0);
    if (board.handle <= 0 ||
        inet_pton(AF_INET, address == NULL ? "127.0.0.1" : address, &here.sin_addr) != 1 ||
        bind(board.handle, (struct sockaddr *)&here, sizeof here) != 0 ||
        getsockname(board.handle, (struct sockaddr *)&here, &bytes) != 0) {
        give_up("firmware: cannot listen");
    }
    printf("port %d\n", (int)ntohs(here.sin_port));
    fflush(stdout);
}

static void answer(const unsigned char *packet, size_t bytes)
{
    if (sendto(board.handle, packet, bytes, 0, (struct sockaddr *)&board.peer,
               board.peer_bytes) < 0) {
        perror("firmware: cannot send");
    }
}

static void answer_refused(const unsigned char *packet, uint32_t why, uint32_t number)
{
    unsigned char refused[HEAD];
    put_head(refused, "NGX1", get32(packet + 4), why, number);
    answer(refused, sizeof refused);
}

/* A start of this gait under the law of the main loop. Others are refused, with the reason. */
static int is_start(const unsigned char *packet, ssize_t bytes)
{
    if (bytes < HEAD || memcmp(packet, "NGS1", 4) != 0) {
        return 0;
    }
    if (bytes != START_BYTES) {
        fprintf(stderr, "firmware: refused a start: this gait takes %d commands\n", NG_COMMANDS);
        answer_refused(packet, OTHER_COMMANDS, NG_COMMANDS);
        return 0;
    }
    if (get32(packet + 8) != NG_LAW_DEFAULT) {
        fprintf(stderr, "firmware: refused a start: its main loop has the law %s alone\n",
                ng_laws[NG_LAW_DEFAULT].name);
        answer_refused(packet, OTHER_LAW, NG_LAW_DEFAULT);
        return 0;
    }
    return get32(packet + 12) < NG_LEGS;
}

static void keep_start(const unsigned char *packet)
{
    unsigned char started[HEAD];
    memcpy(board.start, packet, START_BYTES);
    memcpy(board.reading, packet, HEAD); /* readings are counted from here */
    board.reply_bytes = 0;
    put_head(started, "NGA1", get32(packet + 4), NG_LEG_JOINTS, NG_ACTUATED);
    answer(started, sizeof started);
}

/* Keep a reading. One that comes late is answered with the last command. Returns 0 then. */
static int keep_reading(const unsigned char *packet)
{
    const uint32_t ahead = get32(packet + 4) - get32(board.reading + 4);
    if (ahead == 0u || ahead > 0x7fffffffu) {
        if (board.reply_bytes > 0) {
            unsigned char late[LARGEST];
            memcpy(late, board.reply, board.reply_bytes);
            put_head(late, "NGC1", get32(packet + 4), get32(board.reply + 8) | STALE,
                     get32(board.reply + 12));
            answer(late, board.reply_bytes);
        }
        return 0;
    }
    memcpy(board.reading, packet, READING_BYTES);
    board.began_us = now_us();
    return 1;
}

/* On while readings come; off for a moment when a new start has come. */
int board_enabled(void)
{
    unsigned char packet[LARGEST];
    listen_once();
    if (board.phase == STARTING) {
        board.phase = RUNNING;
        return 1;
    }
    for (;;) {
        board.peer_bytes = sizeof board.peer;
        const ssize_t bytes = recvfrom(board.handle, packet, sizeof packet, 0,
                                       (struct sockaddr *)&board.peer, &board.peer_bytes);
        if (bytes < 0) {
            give_up("firmware: cannot receive");
        }
        if (bytes == HEAD && memcmp(packet, "NGQ1", 4) == 0) {
            exit(0);
        }
        if (is_start(packet, bytes)) {
            const int running = board.phase == RUNNING;
            keep_start(packet);
            board.phase = running ? STARTING : RUNNING;
            return !running;
        }
        if (board.phase == RUNNING && bytes == READING_BYTES &&
            memcmp(packet, "NGR1", 4) == 0 && keep_reading(packet)) {
            return 1;
        }
    }
}

void board_configure(ng_supervisor_config *config)
{
    ng_real options[2];
    get_numbers(board.start + HEAD, options, 2);
    config->walk.blend_s = options[0] > NG(0.0) && ng_finite(options[0]) ? options[0] : NG(0.0);
    for (int i = 0; i < NG_ACTUATED && options[1] > NG(0.0) && ng_finite(options[1]); ++i) {
        config->walk.torque_limit[i] = ng_clamp(options[1], NG(0.0), ng_torque_limit[i]);
    }
}

/* A robot in mid-step walks on; any other one stands first. */
ng_request board_request(void) { return NG_REQUEST_WALK; }

/* A datagram is a tick. */
int board_wait_for_tick(void) { return 1; }

void board_read(ng_encoders *encoders)
{
    const unsigned char *at = board.reading + HEAD;
    encoders->time_us = get32(board.reading + 8);
    at = get_numbers(at, &encoders->pitch, 1);
    at = get_numbers(at, &encoders->dpitch, 1);
    at = get_numbers(at, encoders->base_velocity, 2);
    at = get_numbers(at, encoders->normal_force, NG_LEGS);
    at = get_numbers(at, &encoders->joints[0][0], JOINTS);
    get_numbers(at, &encoders->djoints[0][0], JOINTS);
}

#if NG_COMMANDS
void board_requested(ng_real requested[NG_COMMANDS])
{
    const int started = memcmp(board.reading, "NGR1", 4) == 0;
    const unsigned char *of_reading = board.reading + READING_BYTES - 8 * NG_COMMANDS;
    get_numbers(started ? of_reading : board.start + HEAD + 16, requested, NG_COMMANDS);
}
#endif

void board_drive(ng_real motors[NG_LEGS][NG_LEG_JOINTS])
{
    memcpy(board.motors, motors, sizeof board.motors);
}

/* Plants of the link take torques. */
void board_aim(ng_target targets[NG_LEGS][NG_LEG_JOINTS]) { (void)targets; }

/* The answer is sent here, where all that it holds is known. */
void board_log(const ng_supervisor *supervisor, const ng_supervision *decided)
{
    const ng_command *command = &decided->command;
    const uint32_t flags = (command->leg ? LEG : 0u) | (command->touchdown ? TOUCHDOWN : 0u) |
                           (command->saturated ? SATURATED : 0u);
    unsigned char *at = put_head(board.reply, "NGC1", get32(board.reading + 4), flags,
                                 (uint32_t)command->fault);
    at = put_numbers(at, &board.motors[0][0], JOINTS);
    at = put_numbers(at, &command->torque[0][0], JOINTS);
    at = put_numbers(at, command->actuated, NG_ACTUATED);
    at = put_numbers(at, command->y_d, NG_ACTUATED);
    at = put_numbers(at, command->dy_d, NG_ACTUATED);
    at = put_numbers(at, command->z, 2);
#if NG_COMMANDS
    at = put_numbers(at, supervisor->state.before, NG_COMMANDS);
    at = put_numbers(at, supervisor->state.after, NG_COMMANDS);
#else
    (void)supervisor;
#endif
    const ng_real times[2] = {command->since_touchdown, (ng_real)(now_us() - board.began_us)};
    at = put_numbers(at, times, 2);
    board.reply_bytes = (size_t)(at - board.reply);
    answer(board.reply, board.reply_bytes);
}

void board_changed(const ng_supervision *decided)
{
    fprintf(stderr, "firmware: %s, %s\n", ng_mode_text(decided->mode),
            decided->fault_is_new ? ng_fault_text(decided->fault)
                                  : ng_reason_text(decided->reason));
}

void board_failed(int line)
{
    fprintf(stderr, "firmware: line %d of the self-test failed\n", line);
}
