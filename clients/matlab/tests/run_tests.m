% Tests the functions against a live server.
%   SERVOSCOPE      the program, which simulates measurements
%   SERVOSCOPE_URL  the server
% Run: octave --no-gui --quiet run_tests.m

1;

function check(name, test)
    test();
    printf('ok: %s\n', name);
end

function path = simulated(name)
    path = fullfile(getenv('TEST_FOLDER'), name);
    flags = '--noise-db 60 --harmonics 5 --frequency-range 1:100:9 --fs-plus 0.8 --fs-minus 0.6';
    [failed, text] = system(sprintf('"$SERVOSCOPE" simulate %s', flags));
    assert(failed, 0);
    file = fopen(path, 'w');
    fputs(file, text);
    fclose(file);
end

function refused(identifier, said, action)
    problem = struct('identifier', '', 'message', '');
    try
        action();
    catch problem
    end
    assert(problem.identifier, identifier);
    assert(~isempty(regexp(problem.message, said, 'once')), problem.message);
end

function a_diagnosis_names_static_friction_and_is_drawn()
    measurement = servoscope_upload(simulated('sticky.csv'), 'input', 'current A', ...
        'response', 'velocity rad/s', 'machine', 'press 4', 'inverted', false);
    assert(measurement.experiments, 27);
    assert(measurement.machine, 'press 4');
    result = servoscope_wait(servoscope_diagnose(measurement, 'actuator_order', 0));
    assert(result.verdict, 'explained');
    assert(strncmp(result.headline, 'EXPLAINED: The simulation lacks', 31));
    assert(numel(result.causes), 1);
    assert(result.causes(1).effect, 'static_friction');
    assert(result.causes(1).parameters.fs_plus.value, 0.8, 0.05);
    assert(result.gain.interval95(1) > 1);
    assert(result.extended.parameters.pole.value, -10, 0.05);
    comparison = result.comparison;
    assert(numel(comparison.measured), 27 * 6);
    left = @(model) norm(comparison.measured - comparison.(model));
    assert(left('extended') < left('base'));
    drawing = servoscope_plot(result);
    panels = findobj(drawing, 'type', 'axes', 'tag', '');
    assert(numel(panels), 4);
    assert(numel(findobj(drawing, 'type', 'line')) >= 3 * 10);
    picture = fullfile(getenv('TEST_FOLDER'), 'axis.svg');
    print(drawing, picture, '-dsvg');
    assert(stat(picture).size > 5000);
    close(drawing);
end

function vectors_are_identified()
    period_s = 2;
    lines = 1:29;
    omega = 2 * pi * lines / period_s;
    phase = 2 * pi * mod(lines .^ 2 / 29, 1);
    t = (0:9999)' / 1000;
    u = cos(t * omega + phase) * ones(29, 1);
    ratio = 10 ./ (10 + 1i * omega);
    y = real(exp(1i * (t * omega + phase)) * ratio.') + 1e-3 * sin(1e4 * t .^ 2);
    columns = struct('time_s', t, 'input', u, 'output', y);
    measurement = servoscope_upload(columns, 'input', 'current A', ...
        'response', 'velocity rad/s', 'period_s', period_s);
    result = servoscope_wait(servoscope_identify(measurement, 'actuator_order', 0), ...
        'progress', false);
    assert(result.parameters.pole.value, -10, 0.2);
    assert(result.transfer_function.dc_gain, 1, 0.02);
    assert(all(isnan(result.comparison.extended)));
end

function hostile_names_reach_the_server_as_they_are()
    path = simulated('a "b" $(touch x); ''c''.csv');
    name = 'a "b" $(touch x); `c` \ @d;type=e';
    measurement = servoscope_upload(path, 'name', name);
    assert(measurement.name, name);
    assert(~exist('x', 'file'));
    refused('servoscope:argument', 'line break', ...
        @() servoscope_upload(path, 'name', sprintf('a\noutput = "x"')));
end

function a_refused_upload_says_line_and_column()
    columns = struct('time_s', [0; 1; 2], 'input', [0; 1; NaN], 'output', [0; 1; 0]);
    refused('servoscope:unreadable_measurement', 'line 4, column input', ...
        @() servoscope_upload(columns));
    refused('servoscope:argument', 'different lengths', ...
        @() servoscope_upload(struct('time_s', [0; 1], 'input', 0, 'output', 0)));
    refused('servoscope:file', 'no file', @() servoscope_upload('no such file.csv'));
end

function a_cancelled_job_has_no_result()
    measurement = servoscope_upload(simulated('cancelled.csv'));
    job = servoscope_diagnose(measurement.id, 'options', struct('seed', 2));
    refused('servoscope:timeout', job.id, ...
        @() servoscope_wait(job, 'timeout_s', 0.5, 'progress', false));
    servoscope_cancel(job);
    refused('servoscope:cancelled', job.id, @() servoscope_wait(job.id, 'progress', false));
    refused('servoscope:argument', 'no id', @() servoscope_wait('../../livez'));
    refused('servoscope:argument', 'colour', @() servoscope_identify(measurement, 'colour', 1));
end

function a_server_that_is_not_there_is_an_error()
    servoscope_server('http://127.0.0.1:1', 'secret');
    refused('servoscope:unreachable', 'does not answer', ...
        @() servoscope_result('00000000-0000-0000-0000-000000000000'));
    servoscope_server(getenv('SERVOSCOPE_URL'));
    assert(servoscope_server().api_key, '');
end

addpath(fullfile(fileparts(mfilename('fullpath')), '..'));
warning('off', 'Octave:gnuplot-graphics');
set(0, 'defaultfigurevisible', 'off');
servoscope_server(getenv('SERVOSCOPE_URL'));
tests = {
    @a_diagnosis_names_static_friction_and_is_drawn
    @vectors_are_identified
    @hostile_names_reach_the_server_as_they_are
    @a_refused_upload_says_line_and_column
    @a_cancelled_job_has_no_result
    @a_server_that_is_not_there_is_an_error
};
for i = 1:numel(tests)
    check(strrep(func2str(tests{i}), '_', ' '), tests{i});
end
printf('%d passed\n', numel(tests));
