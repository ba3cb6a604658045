function result = servoscope_result(job)
%SERVOSCOPE_RESULT  Gives the result of a job that has ended.
%   R = servoscope_result(J) gives the result of the job J, a struct or an id.
%
%   Of both kinds of job:
%     R.headline             the verdict in one sentence
%   Of a diagnosis:
%     R.verdict              adequate, explained, improved or unexplained
%     R.discrepancy.sentence where the base model is wrong
%     R.causes               what it lacks, strongest first: effect, confidence,
%                            parameters, explanation, equivalents, gain
%     R.gain.ratio           residual of the base model over that with the
%                            causes, on held-out data; R.gain.interval95
%     R.base, R.extended     identifications without and with the causes
%     R.measurement          faults of the measurement that were found
%   Of an identification:
%     R.parameters           by name: value, std, interval95, unit
%     R.transfer_function    numerator, denominator, poles (re, im), dc_gain
%     R.fit                  chi2_per_dof, nrmse, adequate
%   In names of parameters a point is written as _. Of both:
%     R.comparison           columns: every harmonic as it was measured and as
%                            each model has it; complex amplitudes
%
%   Errors: servoscope:failed, servoscope:cancelled, and the server's own where
%   the job has not ended.
    id = servoscope_job_id(job);
    job = jsondecode(servoscope_request('GET', ['/v1/jobs/' id], struct(), 10));
    switch job.status
        case 'failed'
            error('servoscope:failed', 'job %s failed: %s', id, job.failure.reason);
        case 'cancelled'
            error('servoscope:cancelled', 'job %s was cancelled', id);
    end
    path = ['/v1/jobs/' id];
    result = jsondecode(servoscope_request('GET', [path '/result'], struct(), 60));
    table = servoscope_request('GET', [path '/comparison.csv'], struct(), 60);
    result.comparison = read_comparison(table);
end

function comparison = read_comparison(text)
    lines = strsplit(strtrim(text), sprintf('\n'));
    head = strsplit(lines{1}, ',');
    names = regexprep(head, ' \[.*$', '');
    body = sprintf('%s\n', lines{2:end});
    % An empty cell is a number that there is not.
    body = regexprep(body, ',(?=[,\n])', ',NaN');
    values = sscanf(strrep(body, ',', ' '), '%f', [numel(names) Inf])';
    column = @(name) values(:, strcmp(names, name));
    amplitude = @(name) complex(column([name '_re']), column([name '_im']));
    comparison = struct( ...
        'experiment', column('experiment'), ...
        'magnitude', column('magnitude'), ...
        'omega', column('omega'), ...
        'harmonic', column('harmonic'), ...
        'input', amplitude('u'), ...
        'measured', amplitude('measured'), ...
        'std', column('std'), ...
        'base', amplitude('base'), ...
        'extended', amplitude('extended'));
end
