// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarErrors.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPipelineFilter.h"
#include "pqPipelineSource.h"
#include "pqServerManagerModel.h"

#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkSMProxy.h"
#include "vtkType.h"

#include <QAction>

#include <algorithm>
#include <set>
#include <string>

namespace
{
//------------------------------------------------------------------------------
bool IsOurs(pqPipelineSource* source)
{
  const char* name = source->getProxy()->GetXMLName();
  return name && std::string(name).rfind("AvianLidar", 0) == 0;
}

//------------------------------------------------------------------------------
// True if the data of an output on all ranks, or of an output upstream, are an error. Filters in
// between may have removed the error from the data.
bool HasError(pqOutputPort* port, std::set<pqPipelineSource*>& seen)
{
  pqPipelineSource* source = port ? port->getSource() : nullptr;
  if (!source)
  {
    return false;
  }
  vtkPVDataInformation* data = IsOurs(source) ? port->getDataInformation() : nullptr;
  vtkPVArrayInformation* error =
    data ? data->GetArrayInformation("error", vtkDataObject::FIELD) : nullptr;
  if (error && error->GetDataType() == VTK_STRING)
  {
    return true;
  }
  auto* filter = qobject_cast<pqPipelineFilter*>(source);
  const QList<pqOutputPort*> inputs =
    filter && seen.insert(source).second ? filter->getAllInputs() : QList<pqOutputPort*>();
  return std::any_of(
    inputs.begin(), inputs.end(), [&seen](pqOutputPort* input) { return HasError(input, seen); });
}
}

//------------------------------------------------------------------------------
void AvianLidarGuardSaving(QAction* saving)
{
  // ParaView enables the action for each output that becomes the active one.
  const auto guard = [saving]
  {
    std::set<pqPipelineSource*> seen;
    if (saving->isEnabled() && HasError(pqActiveObjects::instance().activePort(), seen))
    {
      saving->setEnabled(false);
    }
  };
  // Bad data may be good after an update, so ParaView's own rule comes first.
  const auto lookAgain = [saving, guard]
  {
    for (QObject* reaction : saving->children())
    {
      if (reaction->inherits("pqSaveDataReaction"))
      {
        QMetaObject::invokeMethod(reaction, "updateEnableState");
      }
    }
    guard();
  };
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(saving, &QAction::changed, saving, guard);
  QObject::connect(&pqActiveObjects::instance(), &pqActiveObjects::portChanged, saving, guard);
  QObject::connect(model, &pqServerManagerModel::dataUpdated, saving, lookAgain);
}
