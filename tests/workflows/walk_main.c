/*
 * Walks of a scene that Python has written, as a program of its own that sanitizers can watch.
 *
 * walk_main MODEL SCENE STARTS: prints an ending and a number of steps for each start.
 */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>

#include "walk.h"

#define CHUNK 300 /* ticks at a call; all buffers are as long as they must be and no longer */
#define SENSORS (1 + NG_LEGS * NG_LEG_JOINTS)

static void *filled(size_t count, size_t size, const char *path)
{
    FILE *file = path == NULL ? NULL : fopen(path, "rb");
    void *found = calloc(count, size);
    if (found == NULL || (path != NULL && file == NULL)) {
        exit(2);
    }
    if (file != NULL) {
        if (fread(found, size, count, file) != count) {
            exit(2);
        }
        fclose(file);
    }
    return found;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        return 2;
    }
    mjModel *model = mj_loadModel(argv[1], NULL);
    ng_scene *scene = filled(1, sizeof *scene, argv[2]);
    const int starts = atoi(argv[4]), size = 1 + model->nq + model->nv;
    double *begin = filled((size_t)(starts * size), sizeof *begin, argv[3]);
    ng_walk_catch(&mju_user_error);
    scene->model = model;
    scene->step = mj_step;
    scene->config.law = &scene->law;
    if (scene->law.apply_limits) {
        scene->law.apply_limits = ng_clf_qp_apply_limits;
        scene->law.own = &scene->clf_qp;
    }
    for (int i = 0; i < starts; ++i) {
        mjData *data = mj_makeData(model);
        ng_walk *walk = filled(1, sizeof *walk, NULL);
        double *rises = filled((size_t)scene->steps, sizeof *rises, NULL);
        double *late = filled((size_t)((scene->delay_ticks + 1) * model->nu), sizeof *late, NULL);
        double *noise = filled(CHUNK * 2 * SENSORS, sizeof *noise, NULL);
        double *states = filled((size_t)(CHUNK * size), sizeof *states, NULL);
        ng_record *records = filled(CHUNK, sizeof *records, NULL);
        for (int k = 0; k < scene->steps; ++k) {
            rises[k] = 0.005 * (k % 3 - 1);
        }
        for (int k = 0; k < CHUNK * 2 * SENSORS; ++k) {
            noise[k] = 0.1 * (k % 21 - 10);
        }
        data->time = begin[i * size];
        mju_copy(data->qpos, begin + i * size + 1, model->nq);
        mju_copy(data->qvel, begin + i * size + 1 + model->nq, model->nv);
        ng_walk_start(walk, 0, NULL);
        walk->rises = rises;
        walk->late = late;
        while (walk->ending == NG_RUNNING) {
            ng_walk_run(scene, walk, data, CHUNK, noise, records, states);
        }
        printf("%d %d\n", walk->ending, walk->steps);
        free(records), free(states), free(noise), free(late), free(rises), free(walk);
        mj_deleteData(data);
    }
    free(begin), free(scene);
    mj_deleteModel(model);
    return 0;
}
