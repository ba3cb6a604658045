function job = servoscope_submit(kind, measurement, settings)
%SERVOSCOPE_SUBMIT  Queues a job of a kind.
    asked = struct('measurement_id', id_of(measurement), 'kind', kind);
    if mod(numel(settings), 2) ~= 0
        error('servoscope:argument', 'a name has no value');
    end
    for i = 1:2:numel(settings)
        value = settings{i + 1};
        switch settings{i}
            case 'actuator_order'
                asked.plant = struct('actuator_order', value);
            case {'method', 'options'}
                asked.(settings{i}) = value;
            case 'validation'
                asked.validation_measurement_id = id_of(value);
            otherwise
                error('servoscope:argument', 'a job has no setting `%s`', settings{i});
        end
    end
    text = servoscope_request('POST', '/v1/jobs', struct('json', jsonencode(asked)), 30);
    job = jsondecode(text);
end

function id = id_of(measurement)
    id = measurement;
    if isstruct(measurement)
        id = measurement.id;
    end
    id = char(id);
end
