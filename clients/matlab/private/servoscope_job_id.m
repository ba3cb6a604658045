function id = servoscope_job_id(job)
%SERVOSCOPE_JOB_ID  Gives the id of a job, a struct or an id.
    id = job;
    if isstruct(job)
        id = job.id;
    end
    id = char(id);
    if isempty(regexp(id, '^[0-9A-Za-z-]+$', 'once'))
        error('servoscope:argument', '`%s` is no id of a job', id);
    end
end
