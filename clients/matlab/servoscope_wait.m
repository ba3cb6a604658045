function result = servoscope_wait(job, varargin)
%SERVOSCOPE_WAIT  Waits for the end of a job and gives its result.
%   R = servoscope_wait(J) waits for the job J, a struct of servoscope_diagnose
%   or servoscope_identify, or an id, and gives what servoscope_result gives.
%   Meanwhile it prints how far the job has come.
%
%   R = servoscope_wait(J, 'Name', VALUE, ...) with the names
%     timeout_s   longest time to wait, seconds; Inf if left out
%     progress    whether to print; true if left out
%
%   The server may go away and come back meanwhile, for a few minutes.
%
%   Errors: servoscope:failed, servoscope:cancelled, servoscope:timeout (the
%   job goes on), servoscope:unreachable.
    settings = struct('timeout_s', Inf, 'progress', true);
    if mod(numel(varargin), 2) ~= 0
        error('servoscope:argument', 'a name has no value');
    end
    for i = 1:2:numel(varargin)
        if ~isfield(settings, varargin{i})
            error('servoscope:argument', 'waiting has no setting `%s`', varargin{i});
        end
        settings.(varargin{i}) = varargin{i + 1};
    end
    id = servoscope_job_id(job);
    begin = tic();
    shown = '';
    while true
        left_s = max(0, settings.timeout_s - toc(begin));
        wait_s = floor(min(5, left_s));
        job = servoscope_look(id, wait_s);
        if settings.progress && ~isempty(job.progress)
            stage = sprintf('%3.0f %%  %s', 100 * job.progress.fraction, job.progress.stage);
            if ~strcmp(stage, shown)
                fprintf('%s\n', stage);
                shown = stage;
            end
        end
        if ~any(strcmp(job.status, {'queued', 'running'}))
            break
        end
        if left_s <= 0
            error('servoscope:timeout', 'job %s has not ended within %g s', id, settings.timeout_s);
        end
        pause(min(0.2, left_s));
    end
    result = servoscope_result(job);
end

function job = servoscope_look(id, wait_s)
    path = sprintf('/v1/jobs/%s?wait=%d', id, wait_s);
    pauses_s = [1 2 4 8 15 30 60];
    for attempt = 1:numel(pauses_s) + 1
        try
            job = jsondecode(servoscope_request('GET', path, struct(), wait_s));
            return
        catch problem
            away = strcmp(problem.identifier, 'servoscope:unreachable');
            if ~away || attempt > numel(pauses_s)
                rethrow(problem);
            end
            pause(pauses_s(attempt));
        end
    end
end
